#!/usr/bin/env bash
# parameters.sh PROGRAM [--check FILE]: prints docs/parameters.md from the program's field lists; with --check, fails if
# FILE differs.
set -euo pipefail
export LC_ALL=C
program=$1

# The names of the groups of `navigate` with parameters that are the same in `index`, as a list in a sentence.
shared_groups() {
  comm -12 <("$program" params index | sort) <("$program" params navigate | sort) |
    sed -nE 's/^\| `([a-z_]+).*/`\1`/p' | sort -u | paste -sd, | sed 's/,/, /g'
}

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
  printf '\n## Of `track`\n\n'
  "$program" params track
  printf '\n## Of `navigate`\n\n'
  printf 'The table has what `navigate` has alone, or with another default. It also takes these parameters and groups of `index`: %s.\n\n' "$(shared_groups)"
  "$program" params navigate | sed -n 1,2p
  "$program" params navigate | grep -vxF -f <("$program" params index)
  printf '\n## Of `export --format coverage`\n\n'
  "$program" params coverage
  printf '\n## Of `category train`\n\n'
  "$program" params category
}

if [[ "${2:-}" == "--check" ]]; then
  diff -u "$3" <(page) && exit 0
  echo "docs/parameters.md is out of date: tools/parameters.sh build/victorious > docs/parameters.md" >&2
  exit 1
fi
page
