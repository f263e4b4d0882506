#!/bin/sh
# Set up churchpipe in .venv, with the versions of uv.lock: sh scripts/install.sh [uv sync options]
# Needs a shell and Python 3.11 or newer. System libraries that are missing are installed by apt (root or sudo).
set -eu
cd "$(dirname "$0")/.."

say() { echo "churchpipe: $*"; }

python=
for name in "${PYTHON:-}" python3 python3.13 python3.12 python3.11; do
    if [ -n "$name" ] && "$name" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
        python=$name
        break
    fi
done
[ -n "$python" ] || { say "no Python 3.11 or newer found (apt-get install python3, or set PYTHON=/path/to/python3)"; exit 1; }

packages=
has() { "$python" -c "$1" 2>/dev/null; }
has 'import ensurepip, venv' || packages="$packages python3-venv"
# Pictures are drawn off screen by Mesa; gmsh is linked against X11 and OpenGL whether it shows a window or not; Pango sets the PDF.
for library in libEGL.so.1:libegl1 libGL.so.1:libgl1 libGLU.so.1:libglu1-mesa libXrender.so.1:libxrender1 \
    libXcursor.so.1:libxcursor1 libXfixes.so.3:libxfixes3 libXft.so.2:libxft2 libXinerama.so.1:libxinerama1 \
    libfontconfig.so.1:libfontconfig1 libgomp.so.1:libgomp1 libstdc++.so.6:libstdc++6 \
    libpango-1.0.so.0:libpango-1.0-0 libpangoft2-1.0.so.0:libpangoft2-1.0-0 libharfbuzz-subset.so.0:libharfbuzz-subset0; do
    has "import ctypes; ctypes.CDLL('${library%%:*}')" || packages="$packages ${library##*:}"
done
has 'import glob, sys; sys.exit(not glob.glob("/usr/lib*/*/dri/*swrast*") + glob.glob("/usr/lib*/*/libgallium*.so"))' ||
    packages="$packages libgl1-mesa-dri"
has 'import ssl, sys; sys.exit(not ssl.create_default_context().get_ca_certs())' || packages="$packages ca-certificates"

if [ -n "$packages" ]; then
    root=
    [ "$(id -u)" = 0 ] || root=sudo
    if ! command -v apt-get >/dev/null || { [ -n "$root" ] && ! command -v sudo >/dev/null; }; then
        say "please install these first, or what your system calls them:$packages"
        exit 1
    fi
    say "installing system packages:$packages"
    $root apt-get update -q
    # shellcheck disable=SC2086
    $root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $packages
fi

[ -x .venv/bin/python ] || { say "making .venv"; "$python" -m venv .venv; }
if command -v uv >/dev/null; then
    uv=uv
else
    [ -x .venv/bin/uv ] || .venv/bin/python -m pip install -q uv
    uv=.venv/bin/uv
fi
say "installing churchpipe and the versions of uv.lock"
# --inexact keeps uv itself. Where only pip's own index can be reached, pip installs the same versions from there.
# Byte code is made now: each stage of a run is a process, and would take two seconds to make its own where none may be kept.
if ! "$uv" sync -q --frozen --inexact --all-extras --compile-bytecode "$@"; then
    say "uv did not succeed; pip installs the same versions"
    "$uv" export -q --frozen --all-extras --no-hashes --no-emit-project "$@" >.venv/locked.txt
    .venv/bin/python -m pip install -q -r .venv/locked.txt
    .venv/bin/python -m pip install -q --no-deps -e .
fi
.venv/bin/python -m compileall -q src
say "installed: .venv/bin/churchpipe"
