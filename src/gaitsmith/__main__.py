"""``python -m gaitsmith``."""

from gaitsmith.cli.main import main

main()
