#!/bin/sh
# Make the environment: setup.sh PYTHON VENV. What stops it is found before anything is downloaded.
set -eu
python=$1 venv=$2 cache=$2/downloads

say() { echo "set-up, step $1 of 5: $2"; }

# While a process runs: a bar of how many files a folder has, of so many, on a terminal only.
bar() { # PROCESS FOLDER MANY
    while [ -t 2 ] && kill -0 "$1" 2>/dev/null; do
        have=$(ls "$2" 2>/dev/null | wc -l)
        [ "$have" -le "$3" ] || have=$3
        printf '\r[%-50.*s] %d of %d packages' $((have * 50 / $3)) \
            '##################################################' "$have" "$3" >&2
        sleep 0.3
    done
    [ ! -t 2 ] || printf '\r%78s\r' '' >&2
    wait "$1"
}

say 1 "look for Python 3.11 or newer, and for the libraries of the system"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || {
    echo "$python is not Python 3.11 or newer; name one with: make PYTHON=python3.12" >&2
    exit 1
}
"$python" -c 'import venv, ensurepip' 2>/dev/null || {
    echo "$python cannot make a virtual environment; on Debian: sudo apt-get install -y python3-venv" >&2
    exit 1
}
sh workflow/scripts/system_libraries.sh "$python"

say 2 "make $venv and get uv, which installs packages"
"$python" -m venv "$venv"
run="$venv/bin/python"
"$run" -m pip install --quiet --disable-pip-version-check --no-compile --upgrade --require-hashes \
    --target "$cache/uv" -r workflow/installer.lock

# A cache of its own, so that packages are moved, not copied, and no home folder is needed. uv asks
# pip's index where pip was told of another.
index=$("$run" -m pip config list | sed -n "s/^\(global\|:env:\)\.index-url='\(.*\)'/\2/p" | tail -n 1)
export UV_CACHE_DIR="$cache/cache" UV_PYTHON="$run" UV_LINK_MODE=hardlink
[ -z "$index" ] || export UV_DEFAULT_INDEX="${UV_DEFAULT_INDEX:-$index}"
many=$(grep -c '^[a-z].*==' requirements.lock)

say 3 "download and install $many packages, each by its hash (500 MB, a minute or less)"
"$cache/uv/bin/uv" pip install --quiet --no-deps --require-hashes -r requirements.lock &
trap 'kill $!; exit 130' INT TERM # a process in the background does not hear Ctrl-C
bar $! "$UV_CACHE_DIR/archive-v0" "$many"
trap - INT TERM
# Of MKL only what PARDISO calls with GNU's threads, and no package's own tests: a seventh of the size.
rm -f "$venv"/lib/libmkl_intel_thread.* "$venv"/lib/libmkl_tbb_thread.* "$venv"/lib/libmkl_sequential.* \
    "$venv"/lib/libmkl_*ilp64.* "$venv"/lib/libmkl_scalapack* "$venv"/lib/libmkl_blacs* "$venv"/lib/libmkl_cdft*
find "$venv"/lib/ -type d -name tests -prune -exec rm -rf {} +

say 4 "install fingerpad itself, from this folder"
"$cache/uv/bin/uv" pip install --quiet --no-deps --no-build-isolation -e .
rm -rf "$cache"

say 5 "compile the solver's loops for this machine (half a minute)"
# Python's own compiled files first: numba knows a loop by them, and those that a first import writes
# are not the same, so that a second run would compile again.
"$run" -m compileall -q src
"$run" workflow/scripts/compile_kernels.py
echo "set-up: done, in $venv"
