#!/bin/sh
# Install with the tools of development and run the tests, on all cores: sh scripts/test.sh [pytest options]
set -eu
cd "$(dirname "$0")/.."
sh scripts/install.sh --group dev
echo "churchpipe: compiling the loops of the solvers, unless that is done"
.venv/bin/python scripts/compile.py
# In their order: the longest, those of the pipeline, come first, so that all cores end together.
exec .venv/bin/python -m pytest -q -n logical --dist loadfile --no-loadscope-reorder "$@"
