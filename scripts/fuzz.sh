#!/usr/bin/env bash
# scripts/fuzz.sh SECONDS [READER...]: builds the fuzz targets of the readers (preset `fuzz`, clang and its sanitizers) and
# runs each for SECONDS, two at a time, beginning with the files of tests/corpus. What a target finds fails the script and
# lies in build/fuzz/found/READER-*; it becomes a file of the corpus once it is mended. Without clang it prints SKIPPED
# and ends with 77.
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
seconds=${1:?usage: scripts/fuzz.sh SECONDS [READER...]}
shift
build=$root/build/fuzz found=$root/build/fuzz/found

if ! command -v clang++ >/dev/null || ! compgen -G '/usr/lib/llvm-*/lib/clang/*/lib/linux/libclang_rt.fuzzer-*' >/dev/null; then
  echo "SKIPPED: clang and libclang-rt-14-dev are not installed"
  exit 77
fi
mkdir -p "$build" "$found"
cd -- "$root"
if ! { cmake --preset fuzz && cmake --build "$build"; } >"$build/build.log" 2>&1; then
  tail -n 40 -- "$build/build.log"
  echo "the fuzz targets cannot be built; the lines above end $build/build.log"
  exit 1
fi

# The files of the corpus that a target begins with, and the longest input it makes.
seeds() {
  case $1 in
    gltf) echo 'gltf glb' ;;
    mesh_format) echo 'off obj ply stl gltf glb tab' ;;
    plates) echo tab ;;
    map_ply) echo ply ;;
    coefficient_csv | grid_csv) echo csv ;;
    coefficient_json) echo json ;;
    shtools) echo sh ;;
    *) echo "$1" ;;
  esac
}

run() {
  local reader=$1 inputs=$build/inputs/$1 suffix file log=$build/$1.log
  rm -rf -- "$inputs"
  mkdir -p "$inputs/seeds"
  for suffix in $(seeds "$reader"); do
    for file in tests/corpus/accepted/*."$suffix" tests/corpus/refused/*."$suffix" \
      tests/corpus/coefficients/*."$suffix" "tests/fuzz/seeds/$reader"/*; do
      [[ -f $file ]] && cp -- "$file" "$inputs/seeds/"
    done
  done
  # Leaks are looked for; a byte of input may cost time and memory, but within bounds.
  if "$build/tests/fuzz/fuzz_$reader" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=1024 -malloc_limit_mb=256 \
    -max_len=8192 -seed=1 -print_final_stats=1 -artifact_prefix="$found/$reader-" "$inputs/seeds" >"$log" 2>&1; then
    printf '%s: %s runs in %s s, nothing found\n' "$reader" \
      "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" "$seconds"
  else
    printf '%s: FOUND something:\n' "$reader"
    grep -E 'ERROR|SUMMARY|runtime error|Test unit written' -- "$log" || tail -n 20 -- "$log"
    return 1
  fi
}

if (($# == 0)); then
  # mesh_format, which is all of the mesh readers at once, runs when it is asked for.
  set -- off obj ply stl gltf plates map_ply coefficient_csv coefficient_json gfc shtools grid_csv point
fi
rm -f -- "$build/failed"
for reader; do
  while (($(jobs -rp | wc -l) >= 2)); do wait -n || true; done
  { run "$reader" || touch -- "$build/failed"; } &
done
wait
[[ ! -e $build/failed ]]
