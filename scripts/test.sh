#!/bin/sh
# Install with the tools of development and run the tests, on all cores: sh scripts/test.sh [pytest options]
set -eu
cd "$(dirname "$0")/.."
sh scripts/install.sh --group dev
exec .venv/bin/python -m pytest -q -n logical --dist loadfile "$@"
