#!/usr/bin/env bash
# clang_check.sh: builds everything with clang and without precompiled headers, so that each file includes what it uses, and
# runs the program once.
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
build=$root/build/clang
if ! command -v clang++ >/dev/null; then
  echo "SKIPPED: clang is not installed"
  exit 77
fi
mkdir -p "$build"
if ! { cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER=clang++ \
  -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCOWGPU_TOGETHER=OFF && cmake --build "$build"; } >"$build/build.log" 2>&1; then
  tail -n 40 -- "$build/build.log"
  echo "clang cannot build everything; the lines above end $build/build.log"
  exit 1
fi
exec "$build/host/cowgpu" expand builtin:cow --lmax 8 --device cpu
