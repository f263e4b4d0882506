"""The command line: thin. Each command reads its arguments, calls one thing and says what came of it.

Exit codes: 0 done, 1 findings in the input (a case file or a drawing that cannot be taken), 2 usage, 3 the structure or a
solver (unstable, not converged, failed; the report is written all the same).
"""

from churchpipe.cli.app import FINDINGS, INTERRUPTED, STRUCTURE, USAGE, app
from churchpipe.cli.entry import main

__all__ = ["FINDINGS", "INTERRUPTED", "STRUCTURE", "USAGE", "app", "main"]
