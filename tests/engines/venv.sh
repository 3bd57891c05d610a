#!/bin/sh
# Makes target/engines/venv with the engines and Overture's models from PyPI and prints its python; or says in one line why not, and fails.
# The wheels are for CPython 3.12 and newer.

set -eu
cd "$(dirname "$0")/../.."
venv="${NETCERT_ENGINES:-target/engines}/venv"
packages="osrm-bindings==26.10.0 pyvalhalla==3.9.1 osmium==4.3.2 overture-schema==2.0.0"

if [ -x "$venv/bin/python" ] && "$venv/bin/python" -c 'import osmium, osrm, valhalla, overture.schema.transportation' 2>/dev/null; then
    echo "$venv/bin/python"
    exit 0
fi
new_enough='import sys; sys.exit(sys.version_info < (3, 12))'
python=""
for candidate in python3.14 python3.13 python3.12 python3 "$HOME"/.pyenv/versions/3.1[2-9]*/bin/python; do
    if command -v "$candidate" >/dev/null 2>&1 && "$candidate" -c "$new_enough" 2>/dev/null; then
        python="$candidate"
        break
    fi
done
if [ -z "$python" ]; then
    echo "the engines' wheels need python 3.12 or newer" >&2
    exit 1
fi
rm -rf "$venv"
mkdir -p "${venv%/*}"
if ! { "$python" -m venv "$venv" && "$venv/bin/pip" install --quiet --only-binary :all: $packages; } >/dev/null 2>"$venv.log"; then
    echo "no engines from PyPI: $(tail -n 1 "$venv.log")" >&2
    rm -rf "$venv"
    exit 1
fi
echo "$venv/bin/python"
