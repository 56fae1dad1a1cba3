#!/usr/bin/env bash
# demo.sh PROGRAM DRAW_DEMO DIR: draws a short flight, finds two things in it from their photos, and shows the finds.
# Run again, it draws and indexes nothing twice.
set -euo pipefail

if [[ $# -ne 3 ]]; then
  echo "demo.sh: give the program, the drawing program and a folder: demo.sh build/victorious build/draw_demo demo" >&2
  exit 2
fi
program=$1
draw_demo=$2
dir=$3
models=$dir/models
db=$dir/index.db

say() { printf '\n%s\n' "$*"; }

if [[ ! -e $dir/flight.mp4 ]]; then
  say "Drawing a flight over a toy town, with a crate and a truck in it:"
  "$draw_demo" "$dir"
fi

for name in crate truck; do
  if ! "$program" model show "$name" --models "$models" >/dev/null 2>&1; then
    say "Making a searchable model of the $name from its photo:"
    "$program" model add "$name" "$dir/photos/$name.png" --models "$models"
  fi
done

say "Searching the flight for both:"
"$program" index "$dir/flight.mp4" --models "$models" --db "$db"

say "Found, best first:"
"$program" search --db "$db"

echo "(Each thing leaves the view and returns: until objects keep one identity, each is listed twice.)"

say "Compared with what was drawn (sighting_precision and sighting_recall tell how well; 1 is best):"
"$program" evaluate --db "$db" --truth "$dir/truth.jsonl" | grep -v -- ' -$'

"$program" sheet --db "$db" --out "$dir/finds.png"

say "Look at it:"
printf '  %-24s %s\n' \
  "$dir/finds.png" "the finds, outlined" \
  "$dir/flight.mp4" "the flight" \
  "$dir/photos" "what was searched for" \
  "$dir/truth.jsonl" "what was drawn where, frame by frame" \
  "$db" "the index"

cat <<END

Your own photo and video:
  $program model add NAME PHOTO... --models my/models    (a PNG with transparency, or --box x,y,w,h around the thing)
  $program index VIDEO... --models my/models --db my/index.db
  $program search --db my/index.db
  $program sheet --db my/index.db --out my/finds.png
END
