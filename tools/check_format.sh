#!/usr/bin/env bash
# check_format.sh [ROOT]: checks that clang-format-19 would change no tracked C++ file of ROOT (default: the parent of
# this folder), and that comments, which it does not wrap, have at most 120 columns. Exits with 77, which ctest shows as skipped, if clang-format-19 or git's list of files is missing.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

if ! command -v clang-format-19 >/dev/null; then
  echo "SKIPPED: clang-format-19 is not installed (tools/install_packages.sh --test)"
  exit 77
fi
if ! files="$(git ls-files '*.h' '*.cc' '*.cu' 2>/dev/null)" || [[ -z "$files" ]]; then
  echo "SKIPPED: not a git checkout"
  exit 77
fi
xargs --delimiter='\n' clang-format-19 --dry-run -Werror <<<"$files"
if xargs --delimiter='\n' env LC_ALL=C.UTF-8 grep -HnE '^.{121,}$' <<<"$files" | grep -E '^[^:]+:[0-9]+: *//'; then
  echo "comments of more than 120 columns"
  exit 1
fi
