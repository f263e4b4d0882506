#!/bin/sh
# Run the slow tests, and say which figures of README and docs/ they hold: sh scripts/slow.sh [pytest options]
set -eu
cd "$(dirname "$0")/.."
# The report is looked at in a browser, and a sweep runs as jobs of a real SLURM of one node.
packages=
command -v chromium >/dev/null || command -v google-chrome >/dev/null || packages=chromium
# Daemons lie where only root looks for commands.
PATH="$PATH:/usr/sbin"
for command in munged:munge slurmctld:slurmctld slurmd:slurmd sbatch:slurm-client; do
    command -v "${command%%:*}" >/dev/null || packages="$packages ${command##*:}"
done
if [ -n "$packages" ]; then
    root=
    [ "$(id -u)" = 0 ] || root=sudo
    echo "churchpipe: installing system packages: $packages"
    $root apt-get update -q
    # shellcheck disable=SC2086
    $root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $packages
fi
# One at a time: some take gigabytes of memory.
exec sh scripts/test.sh -n 0 -m slow "$@"
