#!/usr/bin/env bash
# demo.sh PROGRAM SCENE MODELS DIR: simulates the flight of SCENE into DIR, searches it for the objects of the scene's
# ground truth with the CAD models MODELS/NAME.glb, and shows the results. A second run reuses all existing results.
set -euo pipefail

if [[ $# -ne 4 ]]; then
  echo "demo.sh: give program, scene, CAD models, folder: demo.sh build/victorious scenes/demo.json assets/models demo" >&2
  exit 2
fi
program=$1
scene=$2
cad=$3
dir=$4
flight=$dir/flight
models=$dir/models
db=$dir/index.db

say() { printf '\n%s\n' "$*"; }

# The video is written last: if it exists, telemetry and truth exist too.
if [[ ! -e $flight/video.mp4 ]]; then
  say "Simulating a flight over a small town:"
  "$program" simulate "$scene" --out "$flight"
fi
# Beside the video, under the name by which every command finds it: the page, too, whatever videos are added there.
cp "$flight/telemetry.csv" "$flight/video.telemetry.csv"

# Another build may give other results: the models, views and index of an older build are deleted.
if [[ -e $models && $program -nt $models ]]; then
  rm -r "$models"
  rm -rf "$dir/views" "$db"*
fi

names=$(sed -n 's/.*"model":"\([^"]*\)".*/\1/p' "$flight/truth.jsonl" | sort -u)
missing=()
for name in $names; do
  "$program" model show "$name" --models "$models" >/dev/null 2>&1 || missing+=("$name")
done
if [[ ${#missing[@]} -gt 0 ]]; then
  say "Making searchable models of ${missing[*]} from the CAD files in $cad, one on each processor:"
  printf '%s\n' "${missing[@]}" |
    xargs -P "$(nproc)" -I NAME "$program" model add NAME "$cad/NAME.glb" --models "$models"
fi
mkdir -p "$dir/views"
for name in $names; do
  if [[ ! -e $dir/views/$name.jpg ]]; then
    "$program" model show "$name" --models "$models" --views "$dir/views/$name.jpg" >/dev/null
  fi
done

say "Searching the flight for" $names "at once:"
"$program" index "$flight/video.mp4" --models "$models" --db "$db"

say "Found, best first:"
"$program" search --db "$db"

# Of the measures of `evaluate` those that a first look needs, and its line of each object.
measures() {
  awk '
    function row(key, name, factor, format, unit) {
      if (value[key] != "" && value[key] != "-") printf "  %-46s " format "%s\n", name, factor * value[key], unit
    }
    /^ / { object[++objects] = $0; next }
    { value[$1] = $2 }
    END {
      row("findable", "objects that can be found", 1, "%8d", "")
      row("found", "objects found", 1, "%8d", "")
      row("false_objects", "false objects", 1, "%8d", "")
      row("sighting_recall", "sightings found (one object in one frame)", 100, "%8.1f", " %")
      row("sighting_precision", "sightings that are right", 100, "%8.1f", " %")
      row("cep50_m", "error of the places, median", 1, "%8.2f", " m")
      row("cep90_m", "error of the places, nine of ten below", 1, "%8.2f", " m")
      row("heading_error_p50_deg", "error of the headings, median", 1, "%8.2f", " degrees")
      for (i = 1; i <= objects; ++i) print object[i]
    }'
}

say "Compared with the simulator's truth:"
"$program" evaluate --db "$db" --truth "$flight/truth.jsonl" | measures

"$program" sheet --db "$db" --out "$dir/finds.jpg"
"$program" export --db "$db" --format kml --out "$dir/finds.kml"
"$program" export --db "$db" --format geojson --out "$dir/finds.geojson"

say "Look at it:"
printf '  %-24s %s\n' \
  "$dir/finds.jpg" "the finds, outlined" \
  "$dir/finds.kml" "the finds in Google Earth (finds.geojson: for other maps)" \
  "$flight/video.mp4" "the flight" \
  "$dir/views" "what was searched for, from every side" \
  "$flight/truth.jsonl" "what stood where, frame by frame" \
  "$db" "the index"

cat <<END_OF_TEXT

See it in the browser, the ranked list beside the video and the map:
  make serve     at http://127.0.0.1:8080/; opens a browser where there is one
  ($program serve --db $db --models $models)

Your own CAD file or photos, and your own video:
  $program model add NAME CAD_FILE --models my/models     (glTF, OBJ, AC3D, COLLADA, 3DS, PLY, STL)
  $program model add NAME PHOTO... --models my/models     (a PNG with transparency, or --box x,y,w,h around the object)
  $program index VIDEO... --models my/models --db my/index.db
  $program search --db my/index.db
  $program sheet --db my/index.db --out my/finds.jpg

To begin anew: rm -r $dir
END_OF_TEXT
