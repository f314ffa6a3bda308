#!/usr/bin/env bash
# package_check.sh BUILD SOURCE: installs the build into an empty folder, builds and runs a client of the library there, then
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
  { head -n 60 "$work/log"; fail "the client's configuration failed"; }
cmake --build "$work/client" >"$work/log" 2>&1 || { head -n 60 "$work/log"; fail "the client does not compile"; }
[[ $("$work/client/client") == "mass 6, Q_20"* ]] || fail "the client found another mass: $("$work/client/client")"
code=0
"$work/client/client" "$work/no-such.off" 2>/dev/null || code=$?
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
echo "client, completion, man page and $count packages passed"
