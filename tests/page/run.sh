#!/usr/bin/env bash
# Tests of the HTML pages in Chromium; installs what they need. The reports must be there (`just validate`).
set -euo pipefail
cd "$(dirname "$0")"
top=$(cd ../.. && pwd)
pages=$top/target/page

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }
if ! command -v chromium >/dev/null && ! command -v chromium-browser >/dev/null && ! command -v google-chrome >/dev/null; then
    as_root apt-get update
    as_root apt-get install -y --no-install-recommends chromium fonts-dejavu-core
fi
if ! command -v npm >/dev/null; then
    as_root apt-get install -y --no-install-recommends nodejs npm
fi
# The driver alone: it uses the browser of the system.
PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 npm ci --silent --no-audit --no-fund

./make.sh "$pages"
node run.mjs "$pages" "$top/reports"
