"""The command line: one file per command, a thin edge over the library."""
