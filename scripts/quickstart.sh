#!/bin/sh
# From nothing to the report of the tilting-test prototype S22: sh scripts/quickstart.sh
set -eu
cd "$(dirname "$0")/.."
sh scripts/install.sh --no-dev
status=0
.venv/bin/churchpipe run pipeline/cases/s22.toml --out runs/s22 || status=$?
# 3: the structure or a solver has bad news, which the report tells.
[ "$status" = 0 ] || [ "$status" = 3 ] || exit "$status"
echo
echo "Open $(pwd)/runs/s22/report.html in a browser."
exit "$status"
