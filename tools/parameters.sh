#!/usr/bin/env bash
# parameters.sh PROGRAM [--check FILE]: prints docs/parameters.md from the program's field lists; with --check, fails if
# FILE differs.
set -euo pipefail
program=$1

page() {
  cat <<'END'
# Parameters

Every parameter of the program, as its field lists hold them.
Printed by `victorious params`; a test keeps this page equal to it.
Give any of them as JSON by `--params FILE`: nested (`{"match": {"ratio": 0.85}}`) or dotted (`{"match.ratio": 0.85}`).
Unknown names and values out of range are refused.
In place of a file a preset may be named: `thesis`, the setting of its chapter 3; `learnt`, the cascade with thresholds
learnt from simulated images; `windows`, categories in windows of many sizes. A file of such a name is `./thesis`.

## Of `index`; `search --image` and `match` take the same file

END
  "$program" params index
  printf '\n## Of `model add`\n\n'
  "$program" params model
  printf '\n## Of `model add` with a CAD file\n\n'
  "$program" params cad
  printf '\n## Of `telemetry`\n\n'
  "$program" params telemetry
  printf '\n## Of `locate`\n\n'
  "$program" params locate
  printf '\n## Of `track`; `model` and `recognize` are as above\n\n'
  "$program" params track | grep -v -E '^\| `(model|recognize)\.'
  printf '\n## Of `navigate`; what is not here is as of `index`\n\n'
  "$program" params navigate | grep -E '^\| (parameter|---|`(landmarks?|telemetry_error|motion|gate_sigma|second_pass|every|lost_every|follow\.(restart_interval_frames|search_interval_s)))'
  printf '\n## Of `category train`\n\n'
  "$program" params category
}

if [[ "${2:-}" == "--check" ]]; then
  diff -u "$3" <(page) && exit 0
  echo "docs/parameters.md is out of date: tools/parameters.sh build/victorious > docs/parameters.md" >&2
  exit 1
fi
page
