#!/usr/bin/env bash
# Measures how an alternation's time and memory grow with handles, example shapes and edge groups:
# a table, the exponents fitted to it, and content/pictures/growth.png.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

usage() {
  cat <<'TEXT'
Usage: tests/benchmarks/growth.sh [OPTIONS]

Runs the benchmarks growth/... and writes build/growth.csv and content/pictures/growth.png.

  --benchmarks FILE  the program (default build/release/bin/limber_benchmarks)
  --all              also 48 handles with 24 shapes, whose bake takes many minutes
  --help             this text
TEXT
}

fail() {
  printf 'growth: %s\n' "$*" >&2
  exit 1
}

program=$top/build/release/bin/limber_benchmarks pattern='^growth/H(4|8|16|32)_'
while [[ $# -gt 0 ]]; do
  case "$1" in
    --benchmarks)
      [[ $# -gt 1 ]] || { usage >&2; exit 2; }
      program=$2
      shift
      ;;
    --all) pattern='^growth/' ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
  shift
done
[[ -x $program ]] || fail "$program: not found; build it (target limber_benchmarks) or name it"
command -v gnuplot > /dev/null ||
  fail "missing: gnuplot (Debian: apt-get install --no-install-recommends gnuplot-nox)"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$program" --benchmark_filter="$pattern" --benchmark_repetitions=5 \
  --benchmark_report_aggregates_only=true --benchmark_out="$work/run.csv" \
  --benchmark_out_format=csv > "$work/log" 2>&1 || { cat "$work/log" >&2; fail "it failed"; }

# The medians: handles, shapes, groups, microseconds, bytes of the model and of a state.
mkdir -p "$top/build"
awk -F, -v OFS=, '
  /^name,/ { for (i = 1; i <= NF; ++i) { gsub(/"/, "", $i); column[$i] = i }; next }
  /_median"/ {
    name = $1
    match(name, /H[0-9]+/); handles = substr(name, RSTART + 1, RLENGTH - 1)
    match(name, /S[0-9]+/); shapes = substr(name, RSTART + 1, RLENGTH - 1)
    print handles, shapes, $column["groups"], $column["cpu_time"], $column["model_bytes"],
      $column["state_bytes"]
  }' "$work/run.csv" | sort -t, -k1n -k2n -k3n > "$work/medians.csv"
[[ -s $work/medians.csv ]] || fail "the program printed no medians"
{ printf 'handles,shapes,groups,microseconds,model_bytes,state_bytes\n'
  cat "$work/medians.csv"; } > "$top/build/growth.csv"

# One series a quantity that grows; the others stay at 8 handles, 4 shapes, 16 groups. Groups are
# twice the handles where handles grow.
series() { awk -F, "$1 { print $2, \$4 }" "$work/medians.csv" | sort -n > "$work/$3"; }
# shellcheck disable=SC2016  # awk's fields, not the shell's
series '$2 == 4 && $3 == 2 * $1' '$1' handles
# shellcheck disable=SC2016
series '$1 == 8 && $3 == 16' '$2' shapes
# shellcheck disable=SC2016
series '$1 == 8 && $2 == 4' '$3' groups

# The slope of the last two points of a series in logarithms: what it tends to.
slope() {
  tail -n 2 "$work/$1" | awk '{ x[NR] = log($1); y[NR] = log($2) }
    END { printf "%.2f", (y[2] - y[1]) / (x[2] - x[1]) }'
}
column -t -s, "$top/build/growth.csv"
printf 'last exponents: handles (groups with them) %s, shapes %s, groups alone %s\n' \
  "$(slope handles)" "$(slope shapes)" "$(slope groups)"

(cd "$work" && gnuplot) <<GNUPLOT
set terminal pngcairo size 1000,620 font "DejaVu Sans,12"
set output "$top/content/pictures/growth.png"
set logscale xy
set title "One alternation, one core (8 handles, 4 shapes, 16 edge groups, and one of them grown)"
set xlabel "number of handles, shapes or groups"
set ylabel "microseconds"
set xtics (2, 4, 8, 16, 32, 64)
set grid
set key left top
plot "handles" with linespoints lw 2 pt 7 lc rgb "#d9372c" \
       title "handles, two groups each: exponent $(slope handles) at the end", \
     "shapes" with linespoints lw 2 pt 5 lc rgb "#2c9d45" \
       title "example shapes: $(slope shapes)", \
     "groups" with linespoints lw 2 pt 9 lc rgb "#2c5fd9" title "edge groups: $(slope groups)"
GNUPLOT
printf 'content/pictures/growth.png\n'
