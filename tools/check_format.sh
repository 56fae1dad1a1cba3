#!/usr/bin/env bash
# Whether every tracked C++ file of ROOT (default: the folder above) is as clang-format-19 writes it. Exits with 77,
# which ctest shows as skipped, where clang-format-19 or git's list of files is missing.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

if ! command -v clang-format-19 >/dev/null; then
  echo "SKIPPED: clang-format-19 is not installed (tools/install_packages.sh --tidy)"
  exit 77
fi
if ! files="$(git ls-files '*.h' '*.cc' '*.cu' 2>/dev/null)" || [[ -z "$files" ]]; then
  echo "SKIPPED: not a git checkout"
  exit 77
fi
xargs --delimiter='\n' clang-format-19 --dry-run -Werror <<<"$files"
