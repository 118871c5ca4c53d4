# shellcheck shell=bash
# How ./check runs its stages and says what each took. Sourced, with `root` set to the folder of the project.

# The stages' logs go to $1; $2 is the mode that the row in times.csv names.
begin_stages() {
  logs=$1 stage_mode=$2 failed=() times=() stages_started=$EPOCHREALTIME
  items=$logs/items
  mkdir -p "$logs"
}

# Seconds between two values of EPOCHREALTIME.
seconds_between() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.1f", b - a }'; }

# Compilers go without the cache where it cannot be written, with a sentence.
use_cache() {
  command -v ccache >/dev/null || return 0
  local folder
  folder=$(ccache --get-config cache_dir 2>/dev/null) || return 0
  if ! { mkdir -p "$folder" && touch "$folder/.fascia" && head -c 1000000 /dev/zero >"$folder/.fascia"; } 2>/dev/null; then
    echo "check: the compiler cache $folder cannot be written (a full disk, or another owner): compiling without it"
    export CCACHE_DISABLE=1
  fi
  rm -f "$folder/.fascia" 2>/dev/null || true
}

# Lines "SECONDS NAME" of what a stage's log, its build (of folder $2: what its log did not say before) and its tests took.
stage_items() {
  local log=$1 build=$2
  cat "$items" 2>/dev/null
  if [ -n "$build" ] && [ -f "build/$build/.ninja_log" ]; then
    grep -vxFf "$items.before" "build/$build/.ninja_log" | awk -F'\t' 'NF >= 4 { printf "%.1f %s\n", ($2 - $1) / 1000, $4 }' |
      sed 's|CMakeFiles/[^/]*/||; s|\.o$||'
  fi
  sed -nE 's/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: (.*[^ .]) \.+.* ([0-9.]+) sec$/\2 \1/p' "$log" 2>/dev/null
  sed -nE 's/^\[ +OK \] (.*) \(([0-9]+) ms\)$/\2 \1/p' "$log" 2>/dev/null | awk '{ printf "%.1f %s\n", $1 / 1000, $2 }'
}

# "  ccache 210 of 214" where the build $1 asked the compiler cache.
cache_hits() {
  local log=build/$1/ccache.log
  [ -n "$1" ] && [ -s "$log" ] || return 0
  awk '/_cache_hit$/ { ++hits } /^cache_miss$/ { ++missed } END { if (hits + missed) printf "  ccache %d of %d", hits, hits + missed }' "$log"
}

# Runs stage_$1 with its output in a log and says how it went, with its three slowest items; the log's end where it
# failed. $2: the folder under build/ in which it compiles.
stage() {
  local name=$1 build=${2:-} log=$logs/$1.log started=$EPOCHREALTIME state=passed
  rm -f "$items" ${build:+"build/$build/ccache.log"}
  cat "build/$build/.ninja_log" >"$items.before" 2>/dev/null || echo none >"$items.before"
  printf 'check: %-8s ' "$name"
  "stage_$name" >"$log" 2>&1 </dev/null || state=FAILED
  report_stage "$name" "$state" "$started" "$build" "$log"
  [ "$state" = passed ] && return
  printf '  the end of %s:\n' "build/check/$name.log"
  tail -n 60 "$log"
  failed+=("$name")
  return 1
}

report_stage() {
  local name=$1 state=$2 took slowest
  took=$(seconds_between "$3" "$EPOCHREALTIME")
  times+=("$name=$took")
  slowest=$(stage_items "$5" "$4" | sort -rn | head -n 3 | awk '{ printf "%s%s %s s", (NR > 1 ? ", " : ""), $2, $1 }')
  printf '%s %6.0f s%s%s\n' "$state" "$took" "$(cache_hits "$4")" "${slowest:+  slowest: $slowest}"
}

# The last stage, whose output was shown: its row, and that of the whole run in times.csv.
end_stages() {
  local name=$1 file=$logs/times.csv columns='date,commit,mode,failed,total,packages,format,release,tidy,asan,fuzz,tsan,lean,debian,tests'
  local row column entry value
  rm -f "$items"
  printf 'check: %-8s ' "$name"
  case " ${failed[*]} " in *" $name "*) entry=FAILED ;; *) entry=passed ;; esac
  report_stage "$name" "$entry" "$2" "" "$logs/$name.log"
  [ "$(head -n 1 "$file" 2>/dev/null)" = "$columns" ] || echo "$columns" >"$file"
  row=$(date -u +%FT%TZ),$(git rev-parse --short HEAD 2>/dev/null || echo none),$stage_mode,"${failed[*]}",$(seconds_between "$stages_started" "$EPOCHREALTIME")
  for column in packages format release tidy asan fuzz tsan lean debian tests; do
    value=
    for entry in "${times[@]}"; do [ "${entry%%=*}" != "$column" ] || value=${entry#*=}; done
    row=$row,$value
  done
  echo "$row" >>"$file"
}
