#!/bin/sh
# Reading speed beside osmium's, on the same file in the same run:
#
#   benches/reading.sh FILE.osm.pbf [RUNS]
#   benches/reading.sh FILE.osm.pbf RUNS BASE.osm.pbf REPLICATE.py COPIES    makes FILE first if it is not there
#
# For comparison: `osmium add-locations-to-ways FILE -f blackhole`, which does the same work (ways with the places of
# their nodes, to nothing). Both use all cores. Printed for each run: wall seconds, CPU seconds, peak memory; then the
# stages of the last reading. Needs osmium-tool and time (apt install osmium-tool time); to make the file, PyPI osmium.
set -eu

file=${1:?usage: benches/reading.sh FILE.osm.pbf [RUNS [BASE.osm.pbf REPLICATE.py COPIES]]}
runs=${2:-3}
here=$(cd "$(dirname "$0")/.." && pwd)

if [ ! -e "$file" ]; then
    "${PYTHON:-python3}" "${4:?no such file, and no script to make it with}" "$3" "$file" --copies "${5:?}"
fi

reader=${READER:-}
if [ -z "$reader" ]; then
    cargo build --release --quiet --manifest-path "$here/Cargo.toml" --example read_extract
    reader=$here/target/release/examples/read_extract
fi

out=$(mktemp)
trap 'rm -f "$out"' EXIT
measure() {
    name=$1
    shift
    # Not time's own -o: a failure of the command must stop the script.
    /usr/bin/time -f "$name: %e s wall, %U s user, %S s system, %M KB" "$@" >"$out"
}

cat "$file" >/dev/null # both find the file in memory
echo "$(nproc) cores, load $(cut -d' ' -f1-3 /proc/loadavg), $(wc -c <"$file") bytes" >&2
run=0
while [ "$run" -lt "$runs" ]; do
    measure osmium osmium add-locations-to-ways "$file" -f blackhole -O -o /dev/null
    measure netcert "$reader" "$file"
    run=$((run + 1))
done
cat "$out"
