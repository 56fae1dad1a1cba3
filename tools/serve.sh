#!/usr/bin/env bash
# serve.sh PROGRAM ARGUMENT...: `PROGRAM serve ARGUMENT...`, and its page in a browser where there is one: by xdg-open on
# a desktop, by `open` on a Mac. The address is printed in any case. Ctrl-C ends the server, not the browser.
set -euo pipefail

if [[ $# -eq 0 ]]; then
  echo "serve.sh: give program and arguments: serve.sh build/victorious --db demo/index.db" >&2
  exit 2
fi

open_page() {
  local opener=
  if [[ "$(uname)" == Darwin ]]; then
    opener=open
  elif [[ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]]; then
    opener=xdg-open
  fi
  [[ -n "$opener" ]] && command -v "$opener" >/dev/null || return 0
  "$opener" "$1" </dev/null >/dev/null 2>&1 &
}

# The server prints one line, its address, once it listens. An interrupt is for the server alone: it says when it ends.
program=$1
shift
"$program" serve "$@" | {
  trap '' INT
  while IFS= read -r address; do
    printf '%s\n' "$address"
    open_page "$address"
  done
}
