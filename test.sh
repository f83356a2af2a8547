#!/usr/bin/env bash
# Everything that must hold before a change lands: build without warnings, all tests, the same tests
# under the sanitizers, and the style checks. Ends with one line: "N passed, N failed, N skipped".
# shellcheck disable=SC2317  # functions are also called through "check"
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
# shellcheck source=setup.sh
. ./setup.sh

usage() {
  cat <<'TEXT'
Usage: ./test.sh [option]...

Installs what is missing (setup.sh), builds, runs every test, checks the style.

  --quick       only the tests labelled quick, nothing else: the loop while you work
  --asan        also build with AddressSanitizer and UBSan and run all but the data-heavy tests
  --no-asan     not that, even where CI is set
  --tidy-all    clang-tidy over every file, however long it takes (default: the newest changes,
                within LIMBER_TIDY_SECONDS, 60 unless set)
  --no-style    no clang-format, clang-tidy and shellcheck
  --jobs N      at most N things at once (default: one per core)
  --help        this text

With CI set in the environment warnings are errors and --asan is the default.
Exit code: 0 everything passed or was skipped with a reason, 1 something failed, 2 wrong usage.
TEXT
}

quick=0 style=1 tidy_all=0 asan=0 jobs=$(nproc 2> /dev/null || echo 2)
[[ -n ${CI:-} ]] && asan=1
while [[ $# -gt 0 ]]; do
  case "$1" in
    --quick) quick=1 ;;
    --asan) asan=1 ;;
    --no-asan) asan=0 ;;
    --tidy-all) tidy_all=1 ;;
    --no-style) style=0 ;;
    --jobs=*) jobs=${1#*=} ;;
    --jobs)
      jobs=${2:-}
      [[ $# -gt 1 ]] && shift
      ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
  shift
done
[[ $jobs =~ ^[1-9][0-9]*$ ]] || { usage >&2; exit 2; }

passed=0 failed=0 skipped=0
started=$SECONDS
title() { printf '\n== %s (at %d s)\n' "$*" $((SECONDS - started)); }

finish() {
  printf '\n%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
  [[ $failed -eq 0 ]] || exit 1
  exit 0
}

# Counts one check that is not a CTest test: check NAME COMMAND...
check() {
  local name=$1
  shift
  if "$@"; then
    printf '%s: passed\n' "$name"
    passed=$((passed + 1))
  else
    printf '%s: FAILED\n' "$name"
    failed=$((failed + 1))
  fi
}

skip() {
  printf '%s: skipped: %s\n' "$1" "$2"
  skipped=$((skipped + 1))
}

# configure_and_build PRESET [CMAKE OPTION]...; a failed build ends the run.
configure_and_build() {
  local preset=$1
  shift
  if ! { cmake --preset "$preset" "$@" > "build/$preset.configure.log" 2>&1 ||
      { cat "build/$preset.configure.log"; false; }; } ||
      ! cmake --build --preset "$preset" --parallel "$jobs"; then
    printf 'build %s: FAILED\n' "$preset"
    failed=$((failed + 1))
    finish
  fi
  printf 'build %s: passed\n' "$preset"
  passed=$((passed + 1))
}

# A number of the report's first element: <testsuite tests="N" failures="N" skipped="N" ...>.
suite_number() {
  head -n 12 "$2" | tr '\n\t' '  ' | sed -n "s/.*<testsuite [^>]* $1=\"\([0-9]*\)\".*/\1/p"
}

# run_tests PRESET NAME CTEST-OPTION...: runs and counts the chosen tests. Windows open on an
# invisible screen where there is none.
run_tests() {
  local preset=$1 name=$2
  shift 2
  local report="$PWD/build/$preset.$name.xml" result=0 screen=() tests failures skips missing
  if [[ -z ${DISPLAY:-} ]] && have xvfb-run; then
    screen=(xvfb-run -a -s '-screen 0 1280x1024x24')
  fi
  rm -f "$report"
  "${screen[@]}" ctest --test-dir "build/$preset" --output-on-failure --no-tests=error -j "$jobs" \
    --output-junit "$report" "$@" || result=$?
  if [[ ! -f $report ]]; then
    printf 'tests %s %s: FAILED: no test ran\n' "$preset" "$name"
    failed=$((failed + 1))
    return 0
  fi
  # CTest counts a test whose program is missing as skipped; it is a failure.
  missing=$(grep -c 'message="Unable to find' "$report" || true)
  tests=$(suite_number tests "$report")
  failures=$(($(suite_number failures "$report") + missing))
  skips=$(($(suite_number skipped "$report") + $(suite_number disabled "$report") - missing))
  passed=$((passed + tests - failures - skips))
  failed=$((failed + failures))
  skipped=$((skipped + skips))
  # The reasons that tests gave for skipping, each once.
  grep -A 1 ': Skipped$' "$report" | grep -vE ': Skipped$|^--$' | sort | uniq -c |
    sed -E 's/^ *([0-9]+) /skipped (\1): /' || true
  if [[ $result -ne 0 && $failures -eq 0 ]]; then
    printf 'tests %s %s: FAILED: ctest ended with %d\n' "$preset" "$name" "$result"
    failed=$((failed + 1))
  fi
}

sources() { git ls-files --cached --others --exclude-standard -- "$@"; }

# A check of nothing is no check.
there_are() {
  [[ $1 -gt 0 ]] || { printf 'no files to look at: is this a clone with git?\n'; return 1; }
}

check_format() {
  local files unformatted
  mapfile -t files < <(sources '*.cpp' '*.h' '*.hpp' '*.c')
  there_are "${#files[@]}" || return 1
  unformatted=$(clang-format --dry-run --Werror "${files[@]}" 2>&1 |
    sed -n 's/^\([^ :]*\):[0-9].*error.*/\1/p' | sort -u)
  [[ -z $unformatted ]] && return 0
  printf 'not as .clang-format wants it; run clang-format -i on:\n%s\n' "$unformatted"
  return 1
}

check_scripts() {
  local files
  mapfile -t files < <(sources '*.sh' .ci/run)
  there_are "${#files[@]}" || return 1
  shellcheck -x "${files[@]}"
}

# Sources with their changes first: uncommitted ones, then by their last commit.
sources_newest_first() {
  {
    git diff --name-only HEAD
    git ls-files --others --exclude-standard
    git log --format= --name-only
  } 2> /dev/null | grep -E '^(runtime|editor_tools)/.*\.cpp$' | awk '!seen[$0]++'
}

# One file of check_tidy; after the deadline it does nothing. tidy_one FILE DEADLINE
tidy_one() {
  [[ $(date +%s) -lt $2 ]] || return 0
  clang-tidy -p build/release --quiet "$1" 2> /dev/null | grep -E '(warning|error):' ||
    true
  printf 'looked at %s\n' "$1"
}
export -f tidy_one

check_tidy() {
  local seconds=${LIMBER_TIDY_SECONDS:-60} files=() file log=build/tidy.log
  [[ $tidy_all -eq 1 ]] && seconds=86400
  while IFS= read -r file; do
    grep -qF "/$file\"" build/release/compile_commands.json && files+=("$file")
  done < <(sources_newest_first)
  there_are "${#files[@]}" || return 1
  # shellcheck disable=SC2016  # expanded by the inner shell
  printf '%s\n' "${files[@]}" | xargs -P "$jobs" -I{} bash -c 'tidy_one "$@"' _ {} \
    "$(($(date +%s) + seconds))" > "$log"
  printf 'clang-tidy: looked at %d of %d files, newest changes first\n' \
    "$(grep -c '^looked at' "$log")" "${#files[@]}"
  # The tree is clean, so whatever is found is new.
  ! grep -E '(warning|error):' "$log" | sort -u | grep .
}

setup_main --for test
pin_software_vulkan
mkdir -p build

title "build release"
strict=()
[[ -n ${CI:-} ]] && strict=(-DLIMBER_WARNINGS_AS_ERRORS=ON)
configure_and_build release "${strict[@]}"

title "quick tests"
run_tests release quick -L quick
[[ $quick -eq 1 ]] && finish
title "all other tests"
run_tests release rest -LE quick

if [[ $style -eq 1 ]]; then
  title "style"
  if have clang-format; then check clang-format check_format; else
    skip clang-format "not installed"; fi
  if have shellcheck; then check shellcheck check_scripts; else
    skip shellcheck "not installed"; fi
  if have clang-tidy; then check clang-tidy check_tidy; else skip clang-tidy "not installed"; fi
fi

if [[ $asan -eq 1 ]]; then
  title "build with AddressSanitizer and UBSan"
  # Warnings are not errors here: instrumented code makes GCC see uninitialised values that are not.
  configure_and_build asan
  title "tests under the sanitizers"
  run_tests asan all -LE data
fi
title "done"
finish
