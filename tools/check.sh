#!/usr/bin/env bash
# check.sh: what can be checked of this source tree without compiling it: the project rules, the format, and clang-tidy on
# the sources that differ from origin/main (from the last commit where there is no such branch). The last two are
# skipped, by name, where clang-format-19 or clang-tidy-19 is not installed (tools/install_packages.sh --tidy).
set -uo pipefail
cd "$(dirname "$0")/.."

status=0
checked() {
  local name=$1
  shift
  "$@"
  local result=$?
  case $result in
    0) echo "$name: ok" >&2 ;;
    77) ;; # skipped; it said why
    *) echo "$name: FAILED" >&2; status=1 ;;
  esac
}

tidy_changed() {
  if ! command -v clang-tidy-19 >/dev/null || ! command -v clang++-19 >/dev/null; then
    echo "SKIPPED: clang-tidy-19 is not installed (tools/install_packages.sh --tidy)"
    return 77
  fi
  local base
  base=$(git merge-base HEAD origin/main 2>/dev/null || git rev-parse HEAD 2>/dev/null) || {
    echo "SKIPPED: not a git checkout"
    return 77
  }
  local changed
  mapfile -t changed < <({ git diff --name-only --diff-filter=d "$base"; git ls-files --others --exclude-standard; } |
    grep -E '\.cc$' | sort -u)
  [[ ${#changed[@]} -eq 0 ]] && return 0
  cmake --preset tidy >/dev/null || return 1
  printf '%s\0' "${changed[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy-19 -p build-tidy --quiet
}

for rule in layers folders nodiscard names throwing words parameters; do
  checked "$rule" python3 "tools/check_$rule.py"
done
tools/results.py --count >&2 # a figure that is stale is no failure
checked format tools/check_format.sh
checked tidy tidy_changed
exit "$status"
