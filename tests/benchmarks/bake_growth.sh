#!/usr/bin/env bash
# Measures how the whole bake grows with the number of vertices: a table, the exponents, and
# content/pictures/bake_growth.png.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

usage() {
  cat <<'TEXT'
Usage: tests/benchmarks/bake_growth.sh [OPTIONS]

Runs the benchmarks bake_growth/... (9 handles, 6 shapes, 2 to 64 thousand vertices, all cores) and
writes build/bake_growth.csv and content/pictures/bake_growth.png. Takes some minutes.

  --benchmarks FILE  the program (default build/release/bin/limber_benchmarks)
  --help             this text
TEXT
}

fail() {
  printf 'bake_growth: %s\n' "$*" >&2
  exit 1
}

program=$top/build/release/bin/limber_benchmarks
while [[ $# -gt 0 ]]; do
  case "$1" in
    --benchmarks)
      [[ $# -gt 1 ]] || { usage >&2; exit 2; }
      program=$2
      shift
      ;;
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
"$program" --benchmark_filter='^bake_growth/' --benchmark_out="$work/run.csv" \
  --benchmark_out_format=csv > "$work/log" 2>&1 || { cat "$work/log" >&2; fail "it failed"; }

# Vertices, then seconds: the whole (counted in milliseconds), weights, tensors.
mkdir -p "$top/build"
awk -F, -v OFS=, '
  /^name,/ { for (i = 1; i <= NF; ++i) { gsub(/"/, "", $i); column[$i] = i }; next }
  /^"bake_growth/ {
    print $column["vertices"], $column["real_time"] / 1000, $column["weights"], $column["tensors"]
  }' "$work/run.csv" | sort -t, -k1g > "$work/rows.csv"
[[ -s $work/rows.csv ]] || fail "the program printed no times"
{ printf 'vertices,seconds,weights,tensors\n'
  cat "$work/rows.csv"; } > "$top/build/bake_growth.csv"

# The slope of the last two points of a column in logarithms: what it tends to.
slope() {
  tail -n 2 "$work/rows.csv" | awk -F, -v c="$1" '{ x[NR] = log($1); y[NR] = log($c) }
    END { printf "%.2f", (y[2] - y[1]) / (x[2] - x[1]) }'
}
column -t -s, "$top/build/bake_growth.csv"
printf 'last exponents: the whole %s, weights %s, tensors %s\n' \
  "$(slope 2)" "$(slope 3)" "$(slope 4)"

(cd "$work" && gnuplot) <<GNUPLOT
set terminal pngcairo size 1000,620 font "DejaVu Sans,12"
set output "$top/content/pictures/bake_growth.png"
set datafile separator ","
set logscale xy
set title "The whole bake, all cores (9 handles, 6 shapes)"
set xlabel "vertices"
set ylabel "seconds"
set xtics ("2k" 2000, "4k" 4000, "8k" 8000, "16k" 16000, "32k" 32000, "64k" 64000)
set grid
set key left top Left reverse
plot "rows.csv" using 1:2 with linespoints lw 2 pt 7 lc rgb "#d9372c" \
       title "all: exponent $(slope 2) at the end", \
     "rows.csv" using 1:3 with linespoints lw 2 pt 5 lc rgb "#2c9d45" \
       title "skinning weights: $(slope 3)", \
     "rows.csv" using 1:4 with linespoints lw 2 pt 9 lc rgb "#2c5fd9" \
       title "tensors: $(slope 4)"
GNUPLOT
printf 'content/pictures/bake_growth.png\n'
