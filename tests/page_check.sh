#!/usr/bin/env bash
# page_check.sh TEST PROGRAM PAGE: runs test/TEST.mjs of the page of reports, which is built in the folder PAGE, with PROGRAM.
set -euo pipefail
test=$1 program=$2 page=$3
skip() {
  echo "SKIPPED: $*"
  exit 77
}
command -v node >/dev/null || skip "there is no node; ./check installs it"
[[ -f $page/report.html ]] || skip "the page of reports is not built: cmake --build DIR --target page"
[[ -d $page/node_modules/puppeteer-core ]] || skip "the page was built without its tests' modules: configure with COWGPU_TESTS=ON"
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || chromium=''
[[ $test != browser || $chromium ]] || skip "there is no chromium; ./check installs it"
COWGPU_PROGRAM=$program COWGPU_PAGE=$page CHROMIUM=$chromium exec node "$page/test/$test.mjs"
