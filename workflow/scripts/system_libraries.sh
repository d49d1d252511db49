#!/bin/sh
# Make sure the shared libraries that the gmsh wheel links to are there: system_libraries.sh PYTHON
# Installs them when root on a Debian-like system, otherwise names them in one line to copy, and stops.
set -eu
python=${1:-python3}
packages="libgl1 libglu1-mesa libgomp1 libfontconfig1 libx11-6 libxcursor1 libxext6 libxfixes3 libxft2 libxinerama1 libxrender1"

loads() { "$python" -c "import gmsh" >/dev/null 2>&1; }

loads && exit 0
if [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then
    export DEBIAN_FRONTEND=noninteractive
    # shellcheck disable=SC2086
    apt-get update -qq && apt-get install -y -qq --no-install-recommends $packages && loads && exit 0
fi
echo "gmsh cannot load: $("$python" -c "import gmsh" 2>&1 | tail -n 1)" >&2
echo "Install its system libraries, then run make again:" >&2
echo "sudo apt-get update && sudo apt-get install -y --no-install-recommends $packages" >&2
exit 1
