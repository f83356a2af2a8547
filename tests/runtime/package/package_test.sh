#!/usr/bin/env bash
# Installs Limber to a fresh prefix and builds consumers in C and C++ from nothing but that prefix,
# through CMake and through pkg-config; looks at what the shared library shows.
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: package_test.sh BUILD_FOLDER

Installs BUILD_FOLDER into a folder of its own, moves that (packages are relocatable), and builds
and runs tests/runtime/package/consumer with it. Prints what it found; exit code 0 if all is well.
TEXT
}
[[ ${1:-} == --help ]] && { usage; exit 0; }
[[ $# -eq 1 ]] || { usage >&2; exit 2; }

build=$(cd "$1" && pwd)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
top=$(cd "$here/../../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  printf 'package: %s\n' "$*" >&2
  exit 1
}

# Names of functions that the headers of the prefix declare, and what the library shows.
symbols() {
  cat "$work"/moved/include/limber/*.h | grep -oE '\blimber[A-Z][A-Za-z]*\(' | tr -d '(' |
    grep -vx limberDefaultContextDef | sort -u > "$work/declared"
  nm -D --defined-only "$1" | awk '$2 != "A" { print $3 }' | sort -u > "$work/exported"
  diff "$work/declared" "$work/exported" || fail "$1: shows other symbols than its headers declare"
  printf 'package: %d symbols, all of the headers\n' "$(wc -l < "$work/exported")"
}

cmake --install "$build" --prefix "$work/first" > "$work/log" || { cat "$work/log"; exit 1; }
mv "$work/first" "$work/moved"
library=$(find "$work/moved" -name liblimber.so)
symbols "$library"
# An engine ships that one file: beside it only what any C++ program of the system needs.
needed=$(readelf -d "$library" | sed -n 's/.*Shared library: \[\(.*\)\]/\1/p' |
  { grep -vE '^(libstdc\+\+|libm|libgcc_s|libc|ld-[a-z0-9_-]+|lib[a-z]+san)\.so' || true; })
[[ -z $needed ]] || fail "$library: needs $needed"

# Only files of the prefix and of the system: the sources must not be needed.
if ! { cmake -S "$here/consumer" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/moved" \
  -DCMAKE_BUILD_TYPE=Release -DCHARACTER="$top/content/characters/square.glb" &&
  cmake --build "$work/build"; } > "$work/log" 2>&1; then
  cat "$work/log"
  exit 1
fi
if grep -rqF "$top" "$work/moved/lib" --include='*.cmake' --include='*.pc'; then
  fail "the package names files of the source folder"
fi
for program in c_runtime cpp_runtime c_runtime_static cpp_runtime_static; do
  said=$("$work/build/$program" "$work/build/baked.glb")
  [[ $said == "moved 0.100 of the diagonal" ]] || fail "$program: said \"$said\""
done
[[ $("$work/build/opener" "$library") == opened ]] || fail "opener"

export PKG_CONFIG_PATH
PKG_CONFIG_PATH=$(dirname "$(find "$work/moved" -name limber.pc)")
read -ra flags <<< "$(pkg-config --cflags --libs limber)"
cc -std=c99 -o "$work/by_pkg_config" "$here/consumer/consumer.c" "${flags[@]}" -lm \
  "-Wl,-rpath,$(dirname "$library")"
[[ $("$work/by_pkg_config" "$work/build/baked.glb") == "moved 0.100 of the diagonal" ]] ||
  fail "the consumer by pkg-config"

# What is not there is said.
rm "$work/moved/bin/limber"
if cmake -S "$here/consumer" -B "$work/again" -DCMAKE_PREFIX_PATH="$work/moved" \
  -DCHARACTER=x > "$work/log" 2>&1; then
  fail "found the component tools where it is not"
fi
grep -q 'component tools: no limber command' "$work/log" || { cat "$work/log"; exit 1; }
printf 'package: consumers in C and C++ run, shared, static, opened and by pkg-config\n'
