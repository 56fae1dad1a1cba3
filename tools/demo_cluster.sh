#!/usr/bin/env bash
# demo_cluster.sh PROGRAM SCENE DEMO DIR: the demo as a cluster does it, on this machine. Four flights are submitted to a
# PostgreSQL database; two nodes of a Slurm cluster run four workers; then the objects and sightings are compared with
# those of one process that indexes into a file. DEMO is the folder of `make demo`, whose flight is one of the four.
# Needs to be root (Slurm) and the packages of tools/install_packages.sh --cluster.
set -euo pipefail

if [[ $# -ne 4 ]]; then
  echo "demo_cluster.sh: give program, scene, folder of the demo, folder: demo_cluster.sh build/victorious scenes/demo.json demo demo/cluster" >&2
  exit 2
fi
program=$(realpath "$1")
scene=$2
demo=$(realpath "$3")
mkdir -p "$4"
dir=$(realpath "$4")
here=$(dirname "$(realpath "$0")")

say() { printf '\n%s\n' "$*"; }

# A scene finds what stands in it in ../assets.
mkdir -p "$dir/scenes"
ln -sfn "$(realpath "$(dirname "$scene")/../assets")" "$dir/assets"

# The first flight is that of the demo; the others are flown along other lines, at another time of day.
videos=()
for flight in 1 2 3 4; do
  video=$dir/archive/flight$flight.mp4
  videos+=("$video")
  [[ -e $video ]] && continue
  mkdir -p "$dir/archive"
  if [[ $flight == 1 ]]; then
    from=$demo/flight
  else
    say "Simulating flight $flight of 4:"
    from=$dir/flight$flight
    sed -e "s/\"seed\": 8,/\"seed\": $((8 + flight)),/" -e 's/"frames": 60/"frames": 30/' \
      -e "s/\"azimuth_deg\": 130/\"azimuth_deg\": $((110 + 10 * flight))/" \
      -e "s/\"from_deg\": \[180, 192\]/\"from_deg\": [$((184 + 4 * flight)), $((190 + 4 * flight))]/" \
      "$scene" >"$dir/scenes/$flight.json"
    "$program" simulate "$dir/scenes/$flight.json" --out "$from"
  fi
  cp "$from/telemetry.csv" "${video%.mp4}.telemetry.csv"
  cp "$from/video.mp4" "$video"
done

work=$(mktemp -d /tmp/victorious-demo-cluster-XXXXXX)
chmod 755 "$work"
coprocs=()
cleanup() {
  # Each server ends with its standard input.
  exec 5>&- 6>&- || true
  wait "${coprocs[@]}" 2>/dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT
trap 'exit 1' HUP INT TERM

# serve FD NAME COMMAND...: starts a server that prints one line once it is ready, and serves until FD is closed.
serve() {
  local fd=$1 name=$2
  shift 2
  mkfifo "$work/$name.in"
  "$@" <"$work/$name.in" >"$work/$name.out" 5>&- 6>&- &
  coprocs+=($!)
  eval "exec $fd>\"\$work/$name.in\""
  while [[ ! -s $work/$name.out ]]; do
    kill -0 "${coprocs[-1]}" 2>/dev/null || { cat "$work/$name.out" >&2; return 1; }
    sleep 0.1
  done
}

say "Starting PostgreSQL, and Slurm with two nodes:"
serve 5 postgres "$here/scratch_postgres.sh"
VICTORIOUS_DB=$(head -n 1 "$work/postgres.out")
mkdir "$work/slurm"
serve 6 slurm "$here/scratch_slurm.sh" "$work/slurm" 2 2
SLURM_CONF=$(head -n 1 "$work/slurm.out")
export VICTORIOUS_DB SLURM_CONF
export VICTORIOUS_PROGRAM=$program
sinfo

say "Submitting four flights:"
"$program" submit "${videos[@]}" --models "$demo/models" --db "$VICTORIOUS_DB"

say "Four workers of one processor, two on each node:"
seconds=$SECONDS
sbatch --wait --array=1-4 --cpus-per-task=1 --chdir="$dir" --output="$dir/worker%a.log" \
  "$here/../cluster/slurm/workers.sbatch" || { cat "$dir"/worker*.log >&2; exit 1; }
say "After $((SECONDS - seconds)) s:"
"$program" cluster status --db "$VICTORIOUS_DB"
grep -h ': done' "$dir"/worker*.log | sed 's/^/  /' || true

say "Found, best first:"
"$program" search --db "$VICTORIOUS_DB"

say "One process indexes the same flights into a file, for comparison:"
rm -f "$dir"/one.db*
"$program" index "${videos[@]}" --models "$demo/models" --db "$dir/one.db"
for format in objects sightings; do
  "$program" export --db "$VICTORIOUS_DB" --format $format --out "$dir/cluster-$format.jsonl" --force
  "$program" export --db "$dir/one.db" --format $format --out "$dir/one-$format.jsonl" --force
done
python3 - "$dir" <<'END'
import json
import sys
from pathlib import Path

folder = Path(sys.argv[1])
for form in ("objects", "sightings"):
    lists = []
    for name in ("cluster", "one"):
        rows = [json.loads(line) for line in (folder / f"{name}-{form}.jsonl").read_text().splitlines()]
        # The ids of objects differ: each video has a range of its own in the database.
        numbers = {}
        lists.append([row | {"object_id": numbers.setdefault(row["object_id"], len(numbers))} for row in rows])
    if lists[0] != lists[1]:
        sys.exit(f"demo_cluster.sh: the {form} of the workers differ from those of one process: {folder}/*-{form}.jsonl")
    print(f"  {len(lists[0])} {form}: the same as those of one process")
END
