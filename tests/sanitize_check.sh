#!/usr/bin/env bash
# sanitize_check.sh readers|all: runs tests under the address and undefined-behaviour sanitizers. `readers`: the quick cases of
# readers and host that need no device, with clang (a few run the program in build/release), in the build of the fuzz targets (preset `fuzz`), which
# are made of the same objects. `all`: every case, in the preset `sanitize`; its memory that the validation layer and the
# drivers keep to the end of the process is no leak of ours.
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
cd -- "$root"

build() { # PRESET TARGET
  local log=$root/build/$1/build.log
  mkdir -p "$root/build/$1"
  if ! { cmake --preset "$1" && cmake --build "build/$1" --target "$2"; } >"$log" 2>&1; then
    tail -n 40 -- "$log"
    echo "$2 cannot be built; the lines above end $log"
    exit 1
  fi
}

if [[ $1 == readers ]]; then
  if ! command -v clang++ >/dev/null || ! compgen -G '/usr/lib/llvm-*/lib/clang/*/lib/linux/libclang_rt.asan-*' >/dev/null; then
    echo "SKIPPED: clang and libclang-rt-14-dev are not installed"
    exit 77
  fi
  build fuzz reader_tests
  exec build/fuzz/tests/fuzz/reader_tests '~[long]~[deep]~[alone]~[cli]'
fi
build sanitize all
ASAN_OPTIONS=detect_leaks=0 exec ctest --test-dir build/sanitize -j"$(nproc)" --output-on-failure --no-tests=error -LE page
