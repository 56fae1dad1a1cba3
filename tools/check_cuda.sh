#!/usr/bin/env bash
# check_cuda.sh [ROOT]: checks that nvcc compiles the CUDA sources of ROOT (default: the parent of this folder), which only
# the preset cuda builds. Exits with 77, which ctest shows as skipped, if nvcc is missing.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

if ! command -v nvcc >/dev/null; then
  echo "SKIPPED: no nvcc"
  exit 77
fi
object="$(mktemp --suffix=.o)"
trap 'rm -f "$object"' EXIT
for source in $(git ls-files '*.cu' 2>/dev/null || find src -name '*.cu'); do
  nvcc -std=c++20 -arch=sm_80 -Werror all-warnings -Isrc -c "$source" -o "$object"
done
