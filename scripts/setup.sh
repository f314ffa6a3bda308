# shellcheck shell=bash
# Packages, configuration and build, shared by ./cowgpu and ./check, which source this file with `root` set to the
# project's folder, and `page` to `required` or `wanted` where the page of reports is to be built too. Everything said here goes to stderr; what fails here ends with exit code 5, an interrupt with 130.

folder=$root/build/release    # where the presets `release` and `check` build
log=$root/build/setup.log     # what the last apt-get, cmake and ninja printed
stamp=$root/build/packages    # the packages last found installed
tools=(g++ cmake ninja pkg-config glslangValidator spirv-val)

say() { printf 'cowgpu: %s\n' "$*" >&2; }

fail() {
  say "$@"
  exit 5
}

fail_with_log() {
  tail -n 40 -- "$log" >&2
  fail "$1; the lines above end $log"
}

# packages GROUP...: the names in those groups of packages.txt, each with a space before and after.
packages() {
  local line name names=' '
  while IFS= read -r line; do
    line=${line%%#*}
    if [[ $line == *:* && " $* " == *" ${line%%:*} "* ]]; then
      for name in ${line#*:}; do names+="$name "; done
    fi
  done <"$root/scripts/packages.txt"
  printf '%s' "$names"
}

# missing NAME...: those that dpkg does not have installed.
missing() {
  local name have
  have=$(dpkg-query --show --showformat '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null) || true
  for name; do
    [[ $'\n'$have$'\n' == *$'\n'"installed $name"$'\n'* ]] || printf '%s ' "$name"
  done
}

# install NAME...: through apt-get, as root or by sudo where sudo needs no password or can ask for one.
install() {
  local line="apt-get install -y --no-install-recommends $*" sudo=()
  if ((EUID != 0)); then
    if sudo -n true 2>/dev/null; then
      sudo=(sudo -n)
    elif [[ -t 0 ]] && command -v sudo >/dev/null; then
      sudo=(sudo)
      sudo -v || fail "sudo failed"
    else
      say "packages are missing, and installing them takes root. As root, run"
      printf 'apt-get update && %s\n' "$line" >&2
      exit 5
    fi
  fi
  local apt=("${sudo[@]}" env DEBIAN_FRONTEND=noninteractive "PATH=$PATH:/usr/sbin:/sbin")
  say "installing packages, this once: $*"
  {
    "${apt[@]}" dpkg --configure -a || true # in case an earlier run was cut short
    "${apt[@]}" apt-get -q update || true # one unreachable source need not matter
    # --no-remove: nothing of the user's goes to make room. The timeout waits for another apt-get to end.
    "${apt[@]}" apt-get -q -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300 --no-remove ${line#apt-get }
  } </dev/null >>"$log" 2>&1 || fail_with_log "apt-get failed"
}

# ensure_packages GROUP...: installs what is missing. Where nothing has changed it asks dpkg nothing.
ensure_packages() {
  local names name lacking='' known=''
  names=$(packages "$@")
  if [[ -f $stamp && ! /var/lib/dpkg/status -nt $stamp ]]; then
    known=$(<"$stamp")
    for name in $names; do
      [[ $known == *" $name "* ]] || lacking=yes
    done
    [[ $lacking ]] || return 0
  fi
  if command -v apt-get >/dev/null; then
    lacking=$(missing $names)
    if [[ $lacking ]]; then
      install $lacking
      installed=yes
    fi
  else
    say "no apt-get here. cowgpu needs what Debian 12 has in these packages:$names"
    for name in "${tools[@]}"; do
      command -v "$name" >/dev/null || fail "$name is missing"
    done
  fi
  printf '%s\n' "$names" >"$stamp"
}

# fetch_bodies: the meshes of Debian's libcgal-demo into build/bodies, for the tests that need them. They lie in one
# archive under the package's documentation, which an installation may leave out, so the package itself is unpacked.
# Nothing fails without a network: those tests are skipped then.
fetch_bodies() {
  local bodies=$root/data/meshes/cgal part=$root/build/bodies.part archive=usr/share/doc/libcgal-dev/data.tar.gz
  local fetch=(apt-get -q -o Acquire::Retries=1 -o Acquire::http::Timeout=20 -o APT::Sandbox::User=root download libcgal-demo)
  [[ ! -d $bodies ]] || return 0
  command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || return 0
  rm -rf -- "$part"
  mkdir -- "$part" || return 0
  say "fetching bodies for the tests, this once"
  if (
    set -e
    cd -- "$part"
    "${fetch[@]}" || { ((EUID == 0)) && apt-get -q update && "${fetch[@]}"; }
    dpkg-deb --fsys-tarfile libcgal-demo_*.deb | tar -xO "./$archive" | tar -xz --strip-components=2 --wildcards 'data/meshes/*.off'
    rm -- libcgal-demo_*.deb
  ) </dev/null >>"$log" 2>&1; then
    mv -- "$part" "$bodies"
  else
    rm -rf -- "$part"
    say "the bodies could not be fetched (see $log): the tests that need them will be skipped"
  fi
}

# configured: whether the build folder is complete and of this source folder (not moved or copied with it).
configured() {
  local home
  [[ -f $folder/build.ninja && -f $folder/CMakeCache.txt ]] || return 1
  home=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$folder/CMakeCache.txt")
  [[ $home -ef $root ]]
}

# configure PRESET: `release` only where nothing is configured, so that it never turns off what `check` turned on.
configure() {
  local fresh=(--fresh)
  if configured; then
    [[ $1 != release ]] || return 0
    fresh=()
  else
    say "configuring"
    rm -f -- "$folder/build.ninja"
  fi
  half=$folder/build.ninja # not to be trusted until cmake is through
  cmake "${fresh[@]}" -S "$root" --preset "$1" </dev/null >>"$log" 2>&1 || { rm -f -- "$half"; return 1; }
  half=''
}

# progress: copies ninja's lines, and shows on a terminal which step it is at. It says nothing where nothing is done.
progress() {
  local line steps told=''
  trap '' INT # ninja hears it, and its last lines are wanted
  while IFS= read -r line; do
    printf '%s\n' "$line"
    [[ $line == '['[1-9]*/*']'* ]] || continue # [0/1] is ninja calling cmake
    if [[ -t 2 ]]; then
      printf '\r\033[K%.79s' "$line" >&2
    elif [[ ! $told ]]; then
      steps=${line#*/}
      say "building (steps: ${steps%%]*})"
    fi
    told=yes
  done
  [[ ! $told || ! -t 2 ]] || printf '\r\033[K' >&2
}

# build PRESET TARGET...
build() {
  configure "$1" || return 1
  NINJA_STATUS='[%f/%t] ' ninja -C "$folder" "${@:2}" </dev/null 2>&1 | progress >>"$log"
}

# build_page: the page of reports, with the node and npm that are there, else with Debian's. It needs npm's registry once.
build_page() {
  local lacking=''
  if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
    ! command -v apt-get >/dev/null || lacking=$(missing $(packages page))
    [[ ! $lacking ]] || (install $lacking) || return 1
  fi
  ninja -C "$folder" page </dev/null >>"$log" 2>&1
}

# set_up PRESET GROUPS TARGET...: one at a time, by a lock that ends with the last process that holds it.
set_up() {
  local lock installed='' half='' groups=$2 arguments=("$1" "${@:3}")
  trap '[[ ! $half ]] || rm -f -- "$half"; exit 130' INT
  mkdir -p -- "$root/build" || exit 5
  exec {lock}>>"$root/build/lock" || exit 5
  if ! flock --timeout 2 "$lock"; then
    say "waiting for another run to finish building"
    flock "$lock"
  fi
  : >"$log" || exit 5
  ensure_packages $groups
  [[ $1 != check ]] || fetch_bodies
  if ! build "${arguments[@]}"; then
    rm -f -- "$stamp" # perhaps a package has gone
    installed=''
    ensure_packages $groups
    if [[ ! $installed ]] || ! build "${arguments[@]}"; then
      fail_with_log "the build failed"
    fi
  fi
  if [[ ${page-} ]] && ! build_page; then
    [[ $page != required ]] || fail_with_log "the page of reports could not be built"
    say "the page of reports could not be built (see $log): what needs it is left out"
  fi
  exec {lock}>&-
  trap - INT
}
