"""Reference data; each file's source and licence stand in ``data/SOURCES.md``."""
