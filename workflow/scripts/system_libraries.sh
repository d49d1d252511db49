#!/bin/sh
# Make sure the shared libraries that the gmsh wheel links to are there: system_libraries.sh PYTHON
# Installs them when root on a Debian-like system, otherwise names them in one line to copy, and stops. Needs no gmsh.
set -eu
python=${1:-python3}
packages="libgl1 libglu1-mesa libgomp1 libfontconfig1 libx11-6 libxcursor1 libxext6 libxfixes3 libxft2 libxinerama1 libxrender1"

missing() {
    "$python" - <<'END'
import ctypes

names = "GL.so.1 GLU.so.1 gomp.so.1 fontconfig.so.1 X11.so.6 Xcursor.so.1 Xext.so.6 Xfixes.so.3 Xft.so.2 Xinerama.so.1 Xrender.so.1"
for name in names.split():
    try:
        ctypes.CDLL(f"lib{name}")
    except OSError:
        print(f"lib{name}", end=" ")
END
}

[ -z "$(missing)" ] && exit 0
if [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then
    export DEBIAN_FRONTEND=noninteractive
    # shellcheck disable=SC2086
    apt-get update -qq && apt-get install -y -qq --no-install-recommends $packages && [ -z "$(missing)" ] && exit 0
fi
echo "gmsh needs these libraries of the system, which are not there: $(missing)" >&2
echo "Install them, then run make again:" >&2
echo "sudo apt-get update && sudo apt-get install -y --no-install-recommends $packages" >&2
echo "Without root: docs/start.md" >&2
exit 1
