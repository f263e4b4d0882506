#!/bin/sh
# Run the slow tests, and say which figures of README and docs/ they hold: sh scripts/slow.sh [pytest options]
set -eu
cd "$(dirname "$0")/.."
exec sh scripts/test.sh -m slow "$@"
