# shellcheck shell=bash
# What passed is not run again as it is: the memory of ./check, in the user's cache directory, for every clone. Sourced,
# and called in the folder of the project. An empty file stands for each program that passed; its name is a digest of
# what the program comes to: itself, the libraries of the system that it loads, meshes beside the checkout, and what
# callers add.

verdicts=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/fascia/passed

# Lines that tell the system's libraries that programs load.
system_libraries() {
  ldd "$@" 2>/dev/null | awk '$3 ~ /^\// { print $3 }' | sort -u | xargs -r stat -L --printf '%n %s %Y\n'
}

# The digest for program $1, with what is said in $2 and further.
verdict_key() {
  { sha256sum <"$1"
    find -L ../shared/meshes -type f -printf '%f %s %T@\n' 2>/dev/null | sort
    system_libraries "$1"
    echo "${@:2}"; } | sha256sum | cut -d' ' -f1
}

passed_before() { [ -e "$verdicts/$1" ] && touch -c "$verdicts/$1"; }

# Remembers the keys given, and forgets those that nobody asked for in three months.
remember_passed() {
  [ $# -gt 0 ] || return 0
  { mkdir -p "$verdicts" && find "$verdicts" -type f -mtime +90 -delete && (cd "$verdicts" && touch "$@"); } 2>/dev/null || true
}

forget_passed() { rm -rf "$verdicts"; }

# The project's files that are no C++. C++ is in the programs; only architecture_test reads it, which is never remembered.
input_files() {
  { if [ -e .git ] && command -v git >/dev/null; then
      git -c core.quotePath=false ls-files -co --exclude-standard
    else
      find -- * .[!.]* -path build -prune -o -type f -print
    fi; } | grep -vE '\.([ch]pp|cuh?)$' | LC_ALL=C sort
}

# The digest of those of them whose names the pattern $1 is found in.
inputs_key() { input_files | grep -E -- "$1" | xargs -d '\n' sha256sum 2>/dev/null | sha256sum | cut -d' ' -f1; }

# What tests depend on beside files: the machine, programs that some call, variables that change how they run.
surroundings() {
  nproc
  grep -m 1 '^model name' /proc/cpuinfo
  nvidia-smi --query-gpu=uuid,driver_version --format=csv
  type -P valgrind nm xvfb-run xauth
  env | grep -E '^(FASCIA|GTEST|OMP|OPENBLAS|CUDA|DISPLAY)' | LC_ALL=C sort
} 2>/dev/null

# Lines "NUMBER LABEL PROGRAM" of all tests of build/$1; PROGRAM is "-" where no test program of the build runs them.
# Fails where ctest does, or tells of more tests.
listed_tests() {
  local text
  text=$(ctest --test-dir "build/$1" -N -V 2>/dev/null) || return 1
  FOLDER="$PWD/build/$1/" awk '
    / Test command: / {
      program = "-"
      start = index($0, ENVIRON["FOLDER"])
      if (start && / "--gtest_filter=/) { program = substr($0, start + length(ENVIRON["FOLDER"])); sub(/ "--gtest_filter=.*/, "", program) }
      gsub(/[" ]/, "_", program)
      label = "-"
    }
    /^Labels: / { label = $2 }
    /^ +Test +#[0-9]+: / { sub(/^ +Test +#/, ""); sub(/:.*/, ""); print $0, label, program; ++tests }
    /^Total Tests: / { total = $3 }
    END { exit tests == total && tests > 0 ? 0 : 1 }' <<<"$text"
}

# Lines "PROGRAM KEY" for the test programs among the lines of listed_tests in file $2. One that
# starts others, as a text of tests/support/run_program.hpp in it tells, depends on fascia and on what that loads.
test_keys() {
  local build=build/$1 program here started all few inputs
  here=$(surroundings)
  started=$(cd "$build" && { cat fascia fascia.bash fascia-picture fascia-*.so libfascia*.so
    system_libraries fascia fascia-picture ./*.so; } 2>/dev/null | sha256sum)
  all=$(inputs_key .) few=$(inputs_key '^(check|cmake/verdicts\.sh|tests/.*CMakeLists\.txt)$')
  awk '$3 != "-" { print $3 }' "$2" | LC_ALL=C sort -u | grep -vx architecture_test | while read -r program; do
    inputs=$few
    if grep -q FASCIA_SOURCE_DIR "$build/$program"; then inputs=$all; fi
    if grep -q 'run_program: cannot start' "$build/$program"; then inputs="$all $started"; fi
    if grep -q FASCIA_DEVICE_MODULE "$build/$program"; then inputs+=$(cat "$build"/fascia-cuda*.so 2>/dev/null | sha256sum); fi
    echo "$program $(verdict_key "$build/$program" "$inputs" "$here")"
  done
}

# Writes to $2/chosen, for ctest's option -I, the numbers of the tests of build/$1 that are to be run, and says how many
# passed before. Fails where that is not known.
choose_tests() {
  local program key
  listed_tests "$1" >"$2/listed" || return 1
  test_keys "$1" "$2/listed" >"$2/keys"
  while read -r program key; do
    if passed_before "$key"; then echo "$program"; fi
  done <"$2/keys" >"$2/before"
  awk 'FILENAME == ARGV[1] { before[$1] = 1; next }
    $2 != "slow" && !($3 in before) { text = text (text == "" ? $1 "," $1 ",1," : ",") $1 }
    END { if (text == "") exit 1; print text }' "$2/before" "$2/listed" >"$2/chosen" || return 1
  awk 'FILENAME == ARGV[1] { before[$1] = 1; ++programs; next } $2 != "slow" && $3 in before { ++tests }
    END { if (tests) printf "check: %d tests of %d programs passed before as they are (--all runs them)\n", tests, programs }' \
    "$2/before" "$2/listed"
}

# Programs of the file $1/listed by what ctest's log $1/tests.log says of their tests that are not slow: $2 "passed",
# all of them, where tests that found no GPU or no mesh may be skipped; or "failed", any of all.
programs_that() {
  WANTED=$2 awk 'FILENAME == ARGV[1] {
      if (match($0, /^ *[0-9]+\/[0-9]+ +Test +#[0-9]+: /)) {
        number = substr($0, 1, RLENGTH); sub(/.*#/, "", number); sub(/:.*/, "", number)
        state[number] = / Passed +[0-9.]+ sec *$/ || /\*\*\*Skipped +[0-9.]+ sec *$/ ? "passed" : "failed"
      }
      next
    }
    $3 != "-" && ($2 != "slow" || $1 in state) { met[$3] = 1; if (state[$1] != "passed") other[$3] = 1; if (state[$1] == "failed") failed[$3] = 1 }
    END { for (program in met) if (ENVIRON["WANTED"] == "passed" ? !(program in other) : program in failed) print program }' \
    "$1/tests.log" "$1/listed" | LC_ALL=C sort
}

# Remembers the programs all of whose tests passed in the run that choose_tests prepared, as they are still.
remember_tests() {
  local keys
  test_keys "$1" "$2/listed" >"$2/keys.after"
  mapfile -t keys < <(LC_ALL=C join <(programs_that "$2" passed) <(LC_ALL=C sort "$2/keys") | grep -xFf - "$2/keys.after" | cut -d' ' -f2)
  remember_passed "${keys[@]}"
}

# Forgets the programs of which tests failed in a run of which nothing is remembered.
forget_failed() {
  local key
  listed_tests "$1" >"$2/listed" || return 0
  test_keys "$1" "$2/listed" >"$2/keys"
  LC_ALL=C join <(programs_that "$2" failed) <(LC_ALL=C sort "$2/keys") | cut -d' ' -f2 |
    while read -r key; do rm -f "$verdicts/$key"; done
}
