#!/usr/bin/env bash
# clang-tidy on the project's sources, as build/release compiles them, and its headers each by itself. What passed is
# remembered in the user's cache by what was really read: the file, its headers, the rules, the tool. Any clone profits.
set -uo pipefail
root=$(cd -P "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root" || exit 1

usage() {
  cat <<'TEXT'
usage: cmake/tidy.sh [--all] [ITEMS]

  Looks at the files that did not pass as they are: of these, the sources that the last 50 commits and the working tree
  changed, and for each header that they changed a source that includes it; and whether each such header compiles by
  itself (one that its own source includes first does). --all: every file that did not pass.
  ITEMS gets a line "SECONDS FILE" for each file that was looked at. Needs a build in build/release.
TEXT
}

all=no
case "${1:-}" in
  -h | --help) usage; exit 0 ;;
  --all) all=yes; shift ;;
esac
items=${1:-/dev/null}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/fascia/tidy
if ! { mkdir -p "$passed" && [ -r "$passed" ] && [ -w "$passed" ] && [ -x "$passed" ]; } 2>/dev/null; then
  echo "tidy: $passed cannot be used; remembering in build/check/tidy"
  passed=build/check/tidy
  mkdir -p "$passed"
fi
find "$passed" -type f -mtime +90 -delete 2>/dev/null

folders=(core meshless fem shells coupling gpu io assembly fascia app)

# "SOURCE HEADER", a line for each file that the compiler read for a source of ours; paths of ours without the root. Of a
# batch the compiler tells the headers of all of its sources: those of ours are followed from each source instead.
grep -rEo --include='*.[ch]pp' '^#include "[^"]+"' "${folders[@]}" | sed -E 's/:#include "(.*)"$/\t\1/' >"$work/quoted"
ninja -C build/release -t deps 2>/dev/null | awk -v root="$root/" -v quoted="$work/quoted" '
  function follow(source, file,    i, n, next_file) {
    if ((source, file) in reached) return
    reached[source, file] = 1
    print source "\t" file
    n = includes[file]
    for (i = 1; i <= n; ++i) {
      next_file = include[file, i]
      if (next_file in read_by_batch) follow(source, next_file)
    }
  }
  function end_batch(    source, path) {
    for (source in batch) {
      follow(source, source)
      for (path in read_by_batch) if (path ~ /^\//) print source "\t" path
    }
    delete batch
    delete read_by_batch
  }
  BEGIN {
    while ((getline line < quoted) > 0) { split(line, pair, "\t"); include[pair[1], ++includes[pair[1]]] = pair[2] }
    is_ours = "^(core|meshless|fem|shells|coupling|gpu|io|assembly|fascia|app)/.*\\.cpp$"
  }
  /^[^ ].*: #deps/ { end_batch(); source = ""; next }
  /^ / {
    path = $0
    sub(/^ +/, "", path)
    if (index(path, root) == 1) path = substr(path, length(root) + 1)
    sub(/^\.\.\/\.\.\//, "", path)
    if (source == "") {
      source = path
      ours = source ~ is_ours && !(source in seen)
      batched = source ~ /\/Unity\/unity_[^\/]*$/
      seen[source] = 1
    }
    if (ours) print source "\t" path
    if (batched) {
      read_by_batch[path] = 1
      if (path ~ is_ours && !(path in seen)) { batch[path] = 1; seen[path] = 1 }
    }
  }
  END { end_batch() }' >"$work/includes"
[ -s "$work/includes" ] || { echo "tidy: build/release knows no sources; build it with ninja first"; exit 1; }

# Each file's content, or for a system's header, whose packages are many files, its size and date.
cut -f2 "$work/includes" | sort -u >"$work/files"
{ grep -v '^/' "$work/files" | grep -v '^build/' | xargs -d '\n' sha256sum 2>/dev/null | sed -E 's/^([^ ]+)  (.*)/\2\t\1/'
  grep '^/' "$work/files" | xargs -d '\n' stat -L --printf '%n\t%s-%Y\n' 2>/dev/null; } >"$work/digests"

# How each source is compiled, those of batches by themselves; without what g++ knows of the processor and clang does not.
mapfile -t processor_flags < <(grep -oE -- ' -m[a-z0-9=.-]+' build/release/compile_commands.json | sort -u | tr -d ' ')
unknown=$(clang++ "${processor_flags[@]}" -fsyntax-only -x c++ /dev/null 2>&1 |
  sed -nE "s/.*unknown argument:? '([^']+)'.*/\1/p" | tr '\n' ' ')
awk -v unknown="$unknown" '
  BEGIN { flags = split(unknown, flag, " ") }
  /^ *"command": / { command = $0 }
  /^ *"directory": / { folder = $0 }
  /^ *"file": / {
    file = $0
    sub(/^ *"file": "/, "", file)
    sub(/",?$/, "", file)
    n = 0
    if (file ~ /\/Unity\/unity_[^\/]*$/) {
      while ((getline line < file) > 0) if (line ~ /^#include "/) { split(line, part, "\""); sources[++n] = part[2] }
      close(file)
    } else sources[++n] = file
    for (i = 1; i <= n; ++i) {
      own = command
      for (f = 1; f <= flags; ++f) if (k = index(own, " " flag[f] " ")) own = substr(own, 1, k) substr(own, k + length(flag[f]) + 2)
      sub(/ -o .*$/, " -c " sources[i] "\",", own)
      printf "%s{\n%s\n%s\n  \"file\": \"%s\"\n}", entries++ ? ",\n" : "[\n", folder, own, sources[i]
    }
  }
  END { print "\n]" }' build/release/compile_commands.json >"$work/compile_commands.json"

# A key for each source: of all that decides what clang-tidy says of it.
mkdir "$work/keys"
{ clang-tidy --version; cat .clang-tidy; grep -o '"command": ".* -o ' build/release/compile_commands.json |
  sed "s|$root||g" | sort -u; } | sha256sum >"$work/rules"
awk -F'\t' -v keys="$work/keys/" '
  NR == FNR { digest[$1] = $2; next }
  { name = $1; gsub(/\//, "%", name); print $2, digest[$2] >(keys name)
    if ($1 != last) { if (last != "") close(keys file); last = $1; file = name } }' "$work/digests" "$work/includes"
(cd "$work/keys" && for file in *; do cat ../rules >>"$file"; done; sha256sum -- *) |
  awk '{ name = $2; gsub(/%/, "/", name); print name, $1 }' >"$work/sources"

while read -r source key; do
  if [ -e "$passed/$key" ]; then echo "$source"; touch -c "$passed/$key"; fi
done <"$work/sources" >"$work/remembered"

# Chooses among the others: what changed lately, and a source for each changed header that no other one shows.
if [ "$all" = no ] && git log -50 --format= --name-only >"$work/log" 2>/dev/null; then
  git status --porcelain --no-renames -uall | cut -c4- >>"$work/log"
  sort -u "$work/log" >"$work/changed"
  awk -F'\t' -v remembered="$work/remembered" -v changed="$work/changed" '
    BEGIN { while ((getline line < remembered) > 0) done[line] = 1
            while ((getline line < changed) > 0) new[line] = 1 }
    { includes[NR] = $0; lines = NR }
    ($1 in new) && !($1 in done) { todo[$1] = 1 }
    END {
      for (i = 1; i <= lines; ++i) { split(includes[i], p, "\t"); if ((p[1] in todo) || (p[1] in done)) shown[p[2]] = 1 }
      for (pass = 0; pass < 2; ++pass)  # a header of the same name first
        for (i = 1; i <= lines; ++i) {
          split(includes[i], p, "\t")
          if (!(p[2] in new) || (p[2] in shown) || p[2] !~ /\.hpp$/) continue
          stem = p[2]; sub(/hpp$/, "cpp", stem)
          if (pass == 0 && stem != p[1]) continue
          todo[p[1]] = 1
          for (k = 1; k <= lines; ++k) { split(includes[k], q, "\t"); if (q[1] == p[1]) shown[q[2]] = 1 }
        }
      for (s in todo) print s
    }' "$work/includes" | sort >"$work/todo"
else
  cut -d' ' -f1 "$work/sources" | grep -vxFf "$work/remembered" >"$work/todo"
fi

# Headers that changed and did not pass: each includes what it uses. One that comes first in the source of its own name
# has been compiled by itself.
find "${folders[@]}" -name '*.hpp' -print0 | xargs -0 grep -L 'cuda_runtime' |
  while read -r header; do
    own=${header%.hpp}.cpp
    [ -f "$own" ] && [ "$(grep -m1 '^#include' "$own")" = "#include \"$header\"" ] || printf '%s\0' "$header"
  done | xargs -0 sha256sum | sed -E 's/^([^ ]+)  (.*)/\2 header-\1/' >"$work/headers"
while read -r header key; do
  if [ -e "$passed/$key" ]; then touch -c "$passed/$key"; else echo "$header $key"; fi
done <"$work/headers" >"$work/unknown_headers"
if [ -e "$work/changed" ]; then
  awk 'NR == FNR { new[$0] = 1; next } $1 in new' "$work/changed" "$work/unknown_headers" >"$work/todo_headers"
else
  cp "$work/unknown_headers" "$work/todo_headers"
fi
mapfile -t include_flags < <(grep -oE -- '-isystem [^ "]+' build/release/compile_commands.json | sort -u | tr ' ' '\n')

header_alone() {
  if c++ -std=c++20 -fsyntax-only -w -I. -Ibuild/release/generated "${@:3}" -x c++ "$1"; then
    : >"$passed/$2" || true
  else
    echo "$1 does not compile by itself: it lacks an include"
    return 1
  fi
}

tidy_file() {
  local started=$EPOCHREALTIME key status=0
  clang-tidy --quiet -p "$work" "$1" 2>"$work/$$.err" || { status=1; cat "$work/$$.err"; }
  if [ "$status" = 0 ]; then
    key=$(awk -v source="$1" '$1 == source { print $2 }' "$work/sources")
    : >"$passed/$key" || true
  fi
  awk -v a="$started" -v b="$EPOCHREALTIME" -v file="$1" 'BEGIN { printf "%.1f %s\n", b - a, file }' >>"$items"
  return "$status"
}
export -f tidy_file header_alone
export work passed items
of=$(wc -l <"$work/sources")
looked=$(wc -l <"$work/todo")
known=$(wc -l <"$work/remembered")
echo "tidy: $looked of $of files looked at, $known passed before, $((of - looked - known)) left to --all"
echo "tidy: $(wc -l <"$work/todo_headers") of $(wc -l <"$work/headers") headers compiled by themselves"
status=0
# shellcheck disable=SC2016 # expanded by the shell that it starts
xargs -a "$work/todo_headers" -d '\n' -r -P "$(nproc)" -I {} bash -c 'header_alone $1 "${@:2}"' headers {} "${include_flags[@]}" || status=1
# shellcheck disable=SC2016
xargs -a "$work/todo" -d '\n' -r -P "$(nproc)" -I {} bash -c 'tidy_file "$1"' tidy {} || status=1
exit "$status"
