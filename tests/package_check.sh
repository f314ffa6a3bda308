#!/usr/bin/env bash
# package_check.sh BUILD SOURCE: installs the build into an empty folder, builds and runs clients of the library there, then
# makes the Debian packages, unpacks them elsewhere and runs the program in them.
set -euo pipefail
build=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

fail() {
  echo "package_check: $*" >&2
  exit 1
}

cmake --install "$build" --prefix "$work/usr" >/dev/null
# The generator and compiler launcher of the build, a cold cache otherwise.
cmake -G Ninja -S "$source/tests/client" -B "$work/client" -DCMAKE_PREFIX_PATH="$work/usr" >"$work/log" 2>&1 ||
  { head -n 60 "$work/log"; fail "the clients' configuration failed"; }
cmake --build "$work/client" >"$work/log" 2>&1 || { head -n 60 "$work/log"; fail "the clients do not compile"; }
client=$work/client
[[ $("$client/moments") == "mass 1, Q_20"* ]] || fail "the client found another mass: $("$client/moments")"
# Moments need none of what reads files, maps or draws.
if ldd "$client/moments" | grep -E 'cairo|netcdf|png|metis|libcowgpu\.so'; then
  fail "the client of the component moments loads what it does not need"
fi
"$client/expand" >"$work/log" || { cat "$work/log"; fail "the client expand failed"; }
for line in 'mass 0\.06' 'harmonic: f_r' 'stretch: f_r' 'smooth: f_r' 'flow: f_r' 'order 7: volume 0\.06'; do
  grep -q "^$line" "$work/log" || { cat "$work/log"; fail "the client expand printed no line $line"; }
done
"$client/tip" >"$work/log" || { cat "$work/log"; fail "the client tip failed"; }
force=$(sed -n 's/^mass .* force \([0-9.]*\) N$/\1/p' "$work/log")
by_program=$("$work/usr/bin/cowgpu" tip builtin:cow@1 --length 2.5m --density 1000kg/m3 --json -q | grep -o '"force_N": [0-9.]*' | head -n 1)
[[ $by_program == "\"force_N\": ${force:0:10}"* ]] || fail "the client tip found $force N, the program $by_program"
(($(grep -c '^order [0-7]: ' "$work/log") == 8)) || { cat "$work/log"; fail "the client tip lacks orders"; }
code=0
"$client/expand" "$work/no-such.off" 2>/dev/null || code=$?
((code == 5)) || fail "the client ended with $code where a file is missing"

# The completion: words, file names, and a colon inside a word.
reply() { (
  source "$work/usr/share/bash-completion/completions/cowgpu"
  COMP_LINE=$1 COMP_POINT=${#1} COMP_WORDBREAKS=$' \t\n"\'><=;|&(:'
  _cowgpu
  printf '%s ' "${COMPREPLY[@]}"
); }
[[ $(reply "cowgpu expa") == "expand " ]] || fail "completion of expa: $(reply "cowgpu expa")"
[[ $(reply "cowgpu transform ro") == "roundtrip " ]] || fail "completion of ro: $(reply "cowgpu transform ro")"
[[ $(reply "cowgpu expand --prog") == "--progress " ]] || fail "completion of --prog"
[[ $(reply "cowgpu expand --verify s") == "sample " ]] || fail "completion of --verify s"
[[ $(reply "cowgpu expand builtin:co") == "cow " ]] || fail "completion of builtin:co: $(reply "cowgpu expand builtin:co")"
grep -q '^\.SS cowgpu transform roundtrip' "$work/usr/share/man/man1/cowgpu.1" || fail "the man page lacks a command"

(cd "$build" && cpack -B "$work/packages" >"$work/log" 2>&1) || { head -n 60 "$work/log"; fail "cpack failed"; }
mkdir "$work/root"
count=0
for package in "$work"/packages/*.deb; do
  dpkg-deb --extract "$package" "$work/root"
  dpkg-deb --field "$package" Depends | grep -q . || fail "$package depends on nothing"
  ((++count))
done
((count == 3)) || fail "$count packages instead of 3"
[[ $(cd / && COWGPU_MESHES='' "$work/root/usr/bin/cowgpu" expand builtin:box:1,2,3 --lmax 2 --device cpu) == *"passed"* ]] ||
  fail "the packaged program does not run"
[[ $(cd / && "$work/root/usr/bin/cowgpu" --version) == "cowgpu "* ]] || fail "the packaged program has no version"
echo "clients, completion, man page and $count packages passed"
