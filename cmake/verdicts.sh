# shellcheck shell=bash
# What passed is not run again as it is: the memory of ./check, in the user's cache directory, for every clone. Sourced,
# and called in the folder of the project. An empty file stands for each program that passed; its name is a digest
# of all that decides what the program comes to.

verdicts=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/fascia/passed

# The digest for program $1, with the libraries of the system that it loads, and what its callers say in $2 and further.
verdict_key() {
  { sha256sum <"$1"
    find -L ../shared/meshes -type f -printf '%f %s %T@\n' 2>/dev/null | sort
    ldd "$1" | awk '$3 ~ /^\// { print $3 }' | xargs -r stat -L --printf '%n %s %Y\n'
    echo "${@:2}"; } | sha256sum | cut -d' ' -f1
}

passed_before() { [ -e "$verdicts/$1" ] && touch -c "$verdicts/$1"; }

# Remembers the keys given, and forgets those that nobody asked for in three months.
remember_passed() {
  [ $# -gt 0 ] || return 0
  { mkdir -p "$verdicts" && find "$verdicts" -type f -mtime +90 -delete && (cd "$verdicts" && touch "$@"); } 2>/dev/null || true
}

forget_passed() { rm -rf "$verdicts"; }

# The digest of the project's files that are no C++: of all of them, or of those that the patterns of grep name. C++ is
# in the programs; only architecture_test reads it, which is never remembered.
inputs_key() {
  { git ls-files -co --exclude-standard 2>/dev/null || find -- * .[!.]* -path build -prune -o -type f -print; } | grep -vE '\.([ch]pp|cuh?)$' | grep -E -- "${1:-.}" | LC_ALL=C sort |
    xargs -d '\n' sha256sum 2>/dev/null | sha256sum | cut -d' ' -f1
}

# Lines "NUMBER NAME PROGRAM" of the tests of the project's build/$1 that are not slow; PROGRAM is "-" where no test program of the
# build runs them.
listed_tests() {
  ctest --test-dir "build/$1" -LE slow -N -V 2>/dev/null | awk -v folder="$PWD/build/$1/" '
    / Test command: / { program = $4; if (!sub("^" folder, "", program) || $0 !~ /--gtest_filter=/) program = "-" }
    /^ +Test +#[0-9]+: / { sub(/^ +Test +#/, ""); number = $1; sub(/:$/, "", number); print number, $2, program }'
}

# Lines "PROGRAM KEY" for the test programs among the lines of listed_tests in file $2. Those that start fascia (a list
# of the build) depend on it and on what it loads.
test_keys() {
  local build=build/$1 program machine started all few inputs
  machine="$(nproc) $(nvidia-smi -L 2>/dev/null)"
  started=$(cd "$build" && cat fascia fascia.bash fascia-picture fascia-*.so libfascia*.so 2>/dev/null | sha256sum)
  all=$(inputs_key) few=$(inputs_key '^(check|tests/.*CMakeLists\.txt)$')
  awk '$3 != "-" { print $3 }' "$2" | sort -u | grep -vx architecture_test | while read -r program; do
    inputs=$few
    if grep -q FASCIA_SOURCE_DIR "$build/$program"; then inputs=$all; fi
    if grep -qx "$program" "$build/tests/starting.txt"; then inputs="$all $started"; fi
    echo "$program $(verdict_key "$build/$program" "$inputs" "$machine")"
  done
}

# Programs of the lines of listed_tests in file $1 all of whose tests passed, or were skipped, as ctest's log $2 tells.
passed_programs() {
  awk 'FILENAME == ARGV[1] { if (/ Test +#[0-9]+: / && / (Passed|\*\*\*Skipped) +[0-9.]+ sec$/) { sub(/.* Test +#[0-9]+: /, ""); passed[$1] = 1 } next }
    $3 != "-" { ran[$3] = 1; if (!($2 in passed)) failed[$3] = 1 }
    END { for (program in ran) if (!(program in failed)) print program }' "$2" "$1"
}

# Writes to $2/chosen, for ctest's option -I, the numbers of the tests of build/$1 that are to be run, and says how many
# passed before.
choose_tests() {
  local program key
  listed_tests "$1" >"$2/listed"
  test_keys "$1" "$2/listed" >"$2/keys"
  while read -r program key; do
    if passed_before "$key"; then echo "$program"; fi
  done <"$2/keys" >"$2/before"
  awk 'FILENAME == ARGV[1] { before[$1] = 1; next } !($3 in before) { text = text (text == "" ? $1 "," $1 ",1," : ",") $1 } END { print text }' \
    "$2/before" "$2/listed" >"$2/chosen"
  awk 'FILENAME == ARGV[1] { before[$1] = 1; ++programs; next } $3 in before { ++tests }
    END { if (tests) printf "check: %d tests of %d programs passed before as they are (--all runs them)\n", tests, programs }' \
    "$2/before" "$2/listed"
}

# Remembers the programs all of whose tests passed in the run that choose_tests prepared.
remember_tests() {
  local keys
  mapfile -t keys < <(join <(passed_programs "$1/listed" "$1/tests.log" | sort) <(sort "$1/keys") | cut -d' ' -f2)
  remember_passed "${keys[@]}"
}
