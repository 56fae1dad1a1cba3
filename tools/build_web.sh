#!/usr/bin/env bash
# build_web.sh [OUT]: type-checks the page of web/ and builds it into OUT (default: build/web). Installs what its
# package-lock.json names first. Does nothing if nothing has changed since the last time.
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(realpath -m "${1:-build/web}")

if ! command -v npm >/dev/null; then
  echo "build_web.sh: npm is not installed: tools/install_packages.sh installs it" >&2
  exit 1
fi
if [[ ! -e web/node_modules/.package-lock.json || web/package-lock.json -nt web/node_modules/.package-lock.json ]]; then
  (cd web && npm ci --no-progress --loglevel=error >&2)
fi
changed=$(find web api/openapi.json -path web/node_modules -prune -o -type f ! -name schema.d.ts -newer "$out/index.html" -print -quit 2>/dev/null || echo first)
if [[ -n $changed ]]; then
  (cd web && npm run --silent build -- --logLevel warn --outDir "$out" >&2)
fi
