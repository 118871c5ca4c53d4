# shellcheck shell=bash
# Shell functions shared by ./run and ./check: packages and builds. Sourced, with `root` set to the folder of the project.

say() { printf 'fascia: %s\n' "$*" >&2; }

# Packages of packages.txt that are needed for $1, one a line: first (before ./run compiles anything), run, check or all.
packages_for() {
  local needed_by package proof
  while read -r needed_by package proof _; do
    case "$1 $needed_by" in
      *" first" | "run run" | "check run" | "check check" | "all "[a-z]*) echo "$package $proof" ;;
    esac
  done < <(grep -v '^#' "${root:?}/cmake/packages.txt")
}

# Those of them that this system lacks. A tool on the PATH counts, wherever it came from.
missing_packages() {
  local package proof
  packages_for "$1" | while read -r package proof; do
    if [ "$proof" != - ] && command -v "$proof" >/dev/null 2>&1; then continue; fi
    dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
  done
}

# Runs a command as root: directly, or through sudo, which may ask for the password.
as_root() {
  if [ "$(id -u)" = 0 ]; then
    "$@"
  elif [ -t 0 ] && [ -z "${CI:-}" ]; then
    sudo "$@"
  else
    sudo -n "$@"
  fi
}

# True when apt knows a version of every package that is still to be had.
apt_knows() {
  local package
  for package in "$@"; do
    LC_ALL=C apt-cache policy "$package" 2>/dev/null | grep -q 'Candidate: [0-9]' || return 1
  done
}

# Installs what $1 (as packages_for) needs and this system lacks; says what and why. $2: log file.
install_missing() {
  local missing log=$2
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    command -v cmake >/dev/null && return 0 # not Debian: the configuration says what is missing
    say "this is no Debian system; please install the counterparts of these Debian packages, then call again:"
    grep -v '^#' "$root/cmake/packages.txt" >&2
    return 1
  fi
  missing=$(missing_packages "$1" | tr '\n' ' ')
  [ -n "$missing" ] || return 0

  say "installing with apt-get what is missing (cmake/packages.txt says what each is for; 520 MB to fetch in all on a bare system): $missing"
  if [ "$(id -u)" != 0 ] && ! command -v sudo >/dev/null; then
    say "that needs root and there is no sudo; as root: apt-get install --no-install-recommends $missing"
    return 1
  fi
  # shellcheck disable=SC2086 # a list of words
  apt_install $missing >>"$log" 2>&1 || { show_log "installing packages" "$log"; return 1; }
}

# Installs packages; refreshes the package lists where they are missing or name versions that are gone.
apt_install() {
  local install="env DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends"
  # Slim images of Debian lack this folder, and Java, which libvtk9-dev wants, cannot be installed without it.
  [ -d /usr/share/man/man1 ] || as_root mkdir -p /usr/share/man/man1
  # shellcheck disable=SC2086 # a command of several words
  { apt_knows "$@" && as_root $install "$@"; } || { as_root apt-get -q update && as_root $install "$@"; }
}

# The end of a log of a step that failed.
show_log() {
  say "$1 failed; the end of $2:"
  tail -n 40 "$2" >&2
}

# True when build/$1 holds a configured build of this very folder (not one that was moved or copied here).
is_configured() {
  local dir="$root/build/$1"
  { [ -f "$dir/build.ninja" ] || [ -f "$dir/Makefile" ]; } &&
    grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$dir/CMakeCache.txt" 2>/dev/null
}

# Configures build/$1 by the preset $2; further arguments go to cmake.
configure() {
  local dir="$root/build/$1" preset=$2 generator=()
  if ! is_configured "$1"; then
    rm -rf "$dir/CMakeCache.txt" "$dir/CMakeFiles"
    if command -v ninja >/dev/null; then generator=(-G Ninja); fi
  fi
  (cd "$root" && cmake --preset "$preset" -B "$dir" "${generator[@]}" "${@:3}")
}

# Optional parts that build/release has made, and makes: they must be of the same build as the program.
made_parts() {
  local part
  for part in $(sed -n 's/^FASCIA_OPTIONAL_PARTS:[A-Z]*=//p' "$root/build/release/CMakeCache.txt" 2>/dev/null | tr ';' ' '); do
    if [ -e "$root/build/release/$part.so" ] || [ -e "$root/build/release/$part" ]; then echo "$part"; fi
  done
}

# True where there is an NVIDIA GPU (the second way is that of virtual machines that hide the driver's files).
has_gpu() { [ -e /proc/driver/nvidia/version ] || nvidia-smi -L >/dev/null 2>&1; }

# Builds targets in build/release, all of them where none is named, and notes when, for ./run: a source saved from here on
# is newer than this build. The program and the parts that were made before always belong to them.
build_release() {
  local started
  if [ $# -gt 0 ]; then
    # shellcheck disable=SC2046 # names of targets
    set -- --target fascia $(made_parts) "$@"
  fi
  started=$(mktemp "$root/build/started.XXXXXX")
  if cmake --build "$root/build/release" "$@"; then
    mv "$started" "$root/build/release/.up_to_date"
  else
    rm -f "$started"
    return 1
  fi
}
