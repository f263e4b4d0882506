#!/bin/sh
# Run the slow tests, and say which figures of README and docs/ they hold: sh scripts/slow.sh [pytest options]
set -eu
cd "$(dirname "$0")/.."
# One at a time: some take gigabytes of memory. The report is looked at in a browser.
if ! command -v chromium >/dev/null && ! command -v google-chrome >/dev/null; then
    root=
    [ "$(id -u)" = 0 ] || root=sudo
    echo "churchpipe: installing the system package chromium"
    $root apt-get update -q
    $root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends chromium
fi
exec sh scripts/test.sh -n 0 -m slow "$@"
