"""`python -m churchpipe`."""

from churchpipe.cli import main

main()
