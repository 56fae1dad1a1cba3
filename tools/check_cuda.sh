#!/usr/bin/env bash
# check_cuda.sh [ROOT]: checks that nvcc compiles the CUDA sources of ROOT (default: the parent of this folder), which
# only the preset cuda builds. Exits with 77, which ctest shows as skipped, without nvcc 12 or later.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

release="$(nvcc --version 2>/dev/null | sed -nE 's/.*release ([0-9]+).*/\1/p' || true)"
if [[ "${release:-0}" -lt 12 ]]; then
  echo "SKIPPED: no nvcc 12 or later"
  exit 77
fi
object="$(mktemp --suffix=.o)"
trap 'rm -f "$object"' EXIT
sources="$(find src -name '*.cu')"
[[ -n "$sources" ]] || { echo "no CUDA source in src/" >&2; exit 1; }
for source in $sources; do
  nvcc -std=c++20 -arch=sm_80 -Werror all-warnings -Isrc -c "$source" -o "$object"
done
