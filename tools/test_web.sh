#!/usr/bin/env bash
# test_web.sh: type-checks and lints the page of web/ and runs its unit tests. SKIPPED (77) where npm or what
# web/package-lock.json names is not installed (tools/build_web.sh installs it).
set -euo pipefail
cd "$(dirname "$0")/../web"
if ! command -v npm >/dev/null || [[ ! -e node_modules/.package-lock.json ]]; then
  echo "SKIPPED: web/node_modules is not there (tools/build_web.sh)"
  exit 77
fi
npm run --silent check
npm run --silent lint
npm test --silent
