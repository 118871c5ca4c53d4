# shellcheck shell=bash
# What passed is not run again as it is: the memory of ./check, in the user's cache directory, for every clone. Sourced,
# and called in the folder of the project. An empty file stands for each program that passed; its name is a digest of
# what the program comes to: itself, the libraries of the system that it loads, meshes beside the checkout, and what
# callers add.

verdicts=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/fascia/passed

# Lines that tell the system's libraries that programs load; those of the build are looked at as they are.
system_libraries() {
  ldd "$@" 2>/dev/null | awk '$3 ~ /^\// { print $3 }' | grep -v /libfascia | sort -u | xargs -r stat -L --printf '%n %s %Y\n'
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

# The project's files, each name ended by a null.
project_files() {
  if [ -e .git ] && git ls-files >/dev/null 2>&1; then
    git ls-files -z -co --exclude-standard
  else
    find . -mindepth 1 -path ./build -prune -o -type f -printf '%P\0'
  fi
}

# The digest of those that are no C++ and whose names the pattern $1 is found in. C++ is in the programs; only
# architecture_test reads it, which is never remembered.
inputs_key() {
  project_files | LC_ALL=C sort -z | grep -zvE '\.([ch]pp|cuh?)$' | grep -zE -- "$1" | xargs -0 sha256sum -- 2>/dev/null |
    sha256sum | cut -d' ' -f1
}

# The same of what says how tests are run.
rules_key() { inputs_key '^(check|cmake/verdicts\.sh|tests/.*CMakeLists\.txt)$'; }

# What tests depend on beside files: the machine, programs that some call, variables that change how they run.
surroundings() {
  nproc
  grep -m 1 '^model name' /proc/cpuinfo
  nvidia-smi --query-gpu=uuid,driver_version --format=csv
  type -P valgrind nm xvfb-run xauth
  env | grep -E '^(FASCIA|GTEST|G?OMP|CUDA|DISPLAY|ASAN_|LANG|LC_)' | LC_ALL=C sort
} 2>/dev/null

# Lines "NUMBER LABEL PROGRAM" of all tests of build/$1; PROGRAM is "-" where no test program of the build runs them.
# Fails where ctest does, or tells of more tests.
listed_tests() {
  local text
  text=$(ctest --test-dir "build/$1" -N -V 2>/dev/null) || return 1
  FOLDER="$PWD/build/$1/" awk '
    / Test command: / {
      gsub(/\\ /, " ")
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

# As a text of tests/support/run_program.hpp in a test program tells.
starts_others() { grep -q 'run_program: cannot start' "$1"; }

# Lines "PROGRAM KEY" for the test programs among the lines of listed_tests in file $2. One that starts others depends on
# fascia and on what that loads; so does one that loads the part for GPUs, where there is that.
test_keys() {
  local build=build/$1 program here started all few inputs
  here=$(surroundings)
  started=$(cd "$build" && { cat fascia fascia.bash fascia-picture fascia-*.so libfascia*.so
    system_libraries fascia fascia-picture ./*.so; } 2>/dev/null | sha256sum)
  all=$(inputs_key .) few=$(rules_key)
  awk '$3 != "-" { print $3 }' "$2" | LC_ALL=C sort -u | grep -vx architecture_test | while read -r program; do
    inputs=$few
    if grep -q FASCIA_SOURCE_DIR "$build/$program"; then inputs=$all; fi
    if starts_others "$build/$program"; then inputs="$all $started"; fi
    if [ -e "$build/fascia-cuda.so" ] && grep -q FASCIA_DEVICE_MODULE "$build/$program"; then inputs+=" $started"; fi
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

# Programs of the file $1/listed by what ctest's log $1/tests.log says of their tests: $2 "passed", all that are not slow;
# "skipped", where some of them were; or "failed", any of all.
programs_that() {
  WANTED=$2 awk 'FILENAME == ARGV[1] {
      if (match($0, /^ *[0-9]+\/[0-9]+ +Test +#[0-9]+: /)) {
        number = substr($0, 1, RLENGTH); sub(/.*#/, "", number); sub(/:.*/, "", number)
        state[number] = / Passed +[0-9.]+ sec *$/ ? "passed" : /\*\*\*Skipped +[0-9.]+ sec *$/ ? "skipped" : "failed"
      }
      next
    }
    $3 != "-" && ($2 != "slow" || $1 in state) {
      worst = state[$1] == "" ? "missing" : state[$1]
      if (worst == "failed" || !($3 in met) || met[$3] == "passed" || met[$3] == "skipped" && worst == "missing") met[$3] = worst
    }
    END { for (program in met) if (met[program] == ENVIRON["WANTED"]) print program }' \
    "$1/tests.log" "$1/listed" | LC_ALL=C sort
}

# Programs of $2/listed, of build/$1, that may be remembered.
ended_well() {
  local program
  { programs_that "$2" passed
    programs_that "$2" skipped | while read -r program; do starts_others "build/$1/$program" || echo "$program"; done; } |
    LC_ALL=C sort
}

# Remembers the programs all of whose tests passed in the run that choose_tests prepared, as they are still. Some may be
# skipped, for want of a mesh or of a GPU, whose absence the key tells; a program that starts others skips for more reasons.
remember_tests() {
  local keys
  test_keys "$1" "$2/listed" >"$2/keys.after"
  mapfile -t keys < <(LC_ALL=C join <(ended_well "$1" "$2") <(LC_ALL=C sort "$2/keys") | grep -xFf - "$2/keys.after" | cut -d' ' -f2)
  remember_passed "${keys[@]}"
}

# Forgets the programs of which tests failed in a run of which nothing is remembered.
forget_failed() {
  local key
  listed_tests "$1" >"$2/listed" || { forget_passed; return; }
  test_keys "$1" "$2/listed" >"$2/keys"
  LC_ALL=C join <(programs_that "$2" failed) <(LC_ALL=C sort "$2/keys") | cut -d' ' -f2 |
    while read -r key; do rm -f "$verdicts/$key"; done
}
