#!/bin/sh
# Two builds of netcert on one extract, in turn and in the same run, with peers beside them:
#
#   benches/compare.sh OLD NEW EXTRACT.osm.pbf [VEHICLE [RUNS]]
#
# OLD and NEW are programs, for example of the last release and of the working tree. Printed for each step: user seconds of both (the
# least of RUNS, 3 by default), their ratio, and what a second of a core does. One thread, so that seconds of work count and not how
# well it is spread. Steps that a program does not know are left out. Peers run if they are installed: osmium; valhalla_build_tiles;
# osrm-extract. Needs sqlite3 and time (apt install sqlite3 time).
set -eu

usage="usage: benches/compare.sh OLD NEW EXTRACT.osm.pbf [VEHICLE [RUNS]]"
old=${1:?$usage}
new=${2:?$usage}
extract=${3:?$usage}
vehicle=${4:-EU-SEMI16.5}
runs=${5:-3}
for needed in sqlite3 /usr/bin/time "$old" "$new"; do
    command -v "$needed" >/dev/null || { echo "$needed is missing" >&2; exit 1; }
done
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
export RAYON_NUM_THREADS=1

# User seconds of a command, or nothing if it fails. `verify` has done its work, too, if it does not confirm a claim (status 1).
seconds() {
    status=0
    /usr/bin/time -o "$dir/time" -f "%U" "$@" >"$dir/out" 2>&1 || status=$?
    case "$status $*" in "0 "* | "1 "*" verify "*) tail -n 1 "$dir/time" ;; esac
}

# The lesser of two numbers; either may be missing.
least() {
    printf '%s\n%s\n' "$1" "$2" | grep . | sort -n | head -n 1
}

# step NAME UNIT SQL ARGUMENTS...: runs both programs in turn. SQL over the database says how much work it was, in UNIT.
step() {
    name=$1 unit=$2 sql=$3
    shift 3
    best_old="" best_new="" run=0
    while [ "$run" -lt "$runs" ]; do
        for which in old new; do
            db=$dir/$which.gpkg
            eval "program=\$$which best=\$best_$which"
            case " $* " in *" ingest "*) rm -f "$db" ;; esac
            # Programs before this option look for no needs.
            off=""
            case " $* " in *" ingest "*) "$program" ingest --help | grep -q -e '--needs' && off="--needs off" ;; esac
            # shellcheck disable=SC2086
            took=$(seconds "$program" "$@" $off --db "$db")
            eval "best_$which=\$(least \"$best\" \"$took\")"
        done
        run=$((run + 1))
    done
    amount=""
    if [ -n "$sql" ] && [ -n "$best_new" ]; then
        amount=$(sqlite3 "$dir/new.gpkg" "$sql")
    fi
    awk -v name="$name" -v a="$best_old" -v b="$best_new" -v unit="$unit" -v amount="$amount" 'BEGIN {
        ratio = (a != "" && b > 0) ? sprintf("%.2f", a / b) : "–"
        rate = (amount != "" && b > 0) ? sprintf("%.0f %s", amount / b, unit) : ""
        printf "| %s | %s | %s | %s | %s |\n", name, a == "" ? "–" : a " s", b == "" ? "–" : b " s", ratio, rate
    }'
}

km="SELECT SUM(length_m) / 1000 FROM edge"
certified="SELECT COUNT(*) * (SELECT SUM(length_m) / 1000 FROM edge) FROM certified_set"
turns="SELECT COUNT(*) FROM turn_certificate_compact"

cat "$extract" >/dev/null # all find the file in memory
echo "$(nproc) cores, load $(cut -d' ' -f1-3 /proc/loadavg), $(wc -c <"$extract") bytes, $vehicle, least of $runs runs" >&2
echo "| step | old | new | old over new | new, for each second of a core |"
echo "| --- | --- | --- | --- | --- |"
step "roads alone" "km" "$km" ingest "$extract" --no-certify
step "all vehicles, lane, no turns" "km × vehicle" "$certified" ingest "$extract" --all-vehicles --no-turns
step "one vehicle, lane, no turns" "km × vehicle" "$certified" ingest "$extract" --vehicle "$vehicle" --no-turns
step "verify up to 2,000 of its edges" "edges" "SELECT MIN(2000, COUNT(*)) FROM certificate_compact" verify --sample 2000
step "one vehicle, lane, with turns" "turns" "$turns" ingest "$extract" --vehicle "$vehicle"
step "one vehicle, carriageway, with turns" "turns" "$turns" ingest "$extract" --vehicle "$vehicle" --corridor carriageway
for which in old new; do
    if [ -e "$dir/$which.gpkg" ]; then
        echo "| bytes of the last database, $which | | $(wc -c <"$dir/$which.gpkg") | | |"
    fi
done

peer() {
    name=$1
    shift
    if command -v "$1" >/dev/null; then
        echo "| $name | | $(seconds "$@") s | | |"
    fi
}
peer "osmium: nodes into ways, to nothing" osmium add-locations-to-ways "$extract" -f blackhole -O -o /dev/null
mkdir "$dir/tiles"
printf '{"mjolnir": {"tile_dir": "%s", "concurrency": 1}}\n' "$dir/tiles" >"$dir/valhalla.json"
peer "valhalla_build_tiles" valhalla_build_tiles -c "$dir/valhalla.json" "$extract"
ln -s "$(cd "$(dirname "$extract")" && pwd)/$(basename "$extract")" "$dir/osrm.osm.pbf"
peer "osrm-extract" osrm-extract --threads 1 --profile "${OSRM_PROFILE:-/usr/share/osrm/profiles/car.lua}" "$dir/osrm.osm.pbf"
