#!/usr/bin/env bash
# test_reproducible.sh BUILD_DIR: packs what BUILD_DIR holds twice, at different times, and fails unless each .deb has the same
# bytes both times. The time of their files is that of the commit (cmake/package_time.cmake), their modes are of umask 022, as of
# `make package`.
set -euo pipefail

if [[ $# -ne 1 || ! -e "$1/CPackConfig.cmake" ]]; then
  echo "test_reproducible.sh: give the folder of a build: test_reproducible.sh build" >&2
  exit 2
fi
build=$(realpath -- "$1")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

umask 022
pack() { # NAME
  (cd "$build" && cpack --config CPackConfig.cmake -G DEB -B "$dir/$1" >"$dir/$1.log" 2>&1) || {
    tail -20 "$dir/$1.log" >&2
    exit 1
  }
}
pack first
sleep 1.1 # times of files have seconds
pack second
for package in "$dir"/first/*.deb; do
  name=$(basename "$package")
  if cmp "$package" "$dir/second/$name"; then continue; fi
  for one in first second; do
    mkdir "$dir/$one.parts"
    dpkg-deb --fsys-tarfile "$dir/$one/$name" | tar -tvf - >"$dir/$one.list"
    (cd "$dir" && ar x "$dir/$one/$name" --output "$dir/$one.parts" && tar -tvf "$dir/$one.parts"/control.tar.* >>"$dir/$one.list")
  done
  diff "$dir/first.list" "$dir/second.list" | head -20 >&2 || true
  echo "test_reproducible.sh: $name: two packages of one build differ" >&2
  exit 1
done
sha256sum "$dir"/first/*.deb | sed "s|$dir/first/||"
