#!/usr/bin/env bash
# fuzz.sh BUILD_DIR [SECONDS]: runs each libFuzzer target of a build (cmake --preset fuzz, target fuzz_targets) for
# SECONDS (default 600). The corpus is kept in BUILD_DIR/fuzz/TARGET/corpus and starts from the target's own seeds.
# Findings and the log are written to BUILD_DIR/fuzz/TARGET.
set -euo pipefail

if [[ $# -lt 1 || $# -gt 2 ]]; then
  echo "usage: $0 BUILD_DIR [SECONDS]" >&2
  exit 2
fi
build="$(cd "$1" && pwd)"
seconds="${2:-600}"

status=0
for replay in "$build"/fuzz_*_replay; do
  target="${replay%_replay}"
  name="$(basename "$target")"
  folder="$build/fuzz/$name"
  mkdir -p "$folder/corpus"
  "$replay" --write "$folder/corpus"
  echo "$name: $seconds s" >&2
  "$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -max_len=65536 -print_final_stats=1 \
    -artifact_prefix="$folder/" "$folder/corpus" >"$folder/log" 2>&1 || status=1
  grep -E '^stat::number_of_executed_units|SUMMARY:' "$folder/log" | sed "s/^/$name: /" >&2 || true
done
exit "$status"
