#!/usr/bin/env bash
# Names the test programs that ctest's arguments ask for: with -R NAMES those whose sources, or whose own names, contain
# what the pattern looks for; otherwise, or where nothing is found, nothing, which means all of them.
# tests/targets.txt of the build has a line "PROGRAM SOURCE" for each test source.
set -uo pipefail
root=$(cd -P "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
pattern=
while [ $# -gt 0 ]; do
  case $1 in
    -R | --tests-regex) pattern=${2:-}; break ;;
    -R*) pattern=${1#-R}; break ;;
  esac
  shift
done
[ -n "$pattern" ] || exit 0
# A pattern may join the parts of a name, "PROGRAM.Suite.Test": each is looked for by itself.
words=$(sed -E 's/\\?\.\*?/|/g; s/^[|^]+//; s/[|$]+$//' <<<"$pattern")
while read -r program source; do
  if grep -qE -- "$words" <<<"$program" || grep -E "^ *(TEST|TYPED_TEST|INSTANTIATE)" "$source" | grep -qE -- "$words"; then echo "$program"; fi
done <"${FASCIA_BUILD:-$root/build/release}/tests/targets.txt" | sort -u
