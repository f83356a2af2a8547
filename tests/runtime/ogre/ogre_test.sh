#!/usr/bin/env bash
# Drags the shipped characters inside OGRE, an engine that is not ours, with nothing of Limber but
# its installed package; looks at the vertices in the engine's buffers and at its pictures.
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: ogre_test.sh BUILD_FOLDER

Installs BUILD_FOLDER into a folder of its own, builds tests/runtime/ogre/host with that and OGRE
1.12, bakes the characters with the installed command and drags them without a screen. The pictures
stay in BUILD_FOLDER/tests/runtime/ogre. Exit code 0 if all is well, 77 if OGRE or Xvfb is missing.
TEXT
}
[[ ${1:-} == --help ]] && { usage; exit 0; }
[[ $# -eq 1 ]] || { usage >&2; exit 2; }

build=$(cd "$1" && pwd)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
content=$(cd "$here/../../../content/characters" && pwd)
num_pictures=10

fail() {
  printf 'ogre: %s\n' "$*" >&2
  exit 1
}
skip() {
  printf 'ogre: skipped: %s\n' "$*"
  exit 77
}
pkg-config --exists 'OGRE >= 1.12' 'OGRE < 13' 2> /dev/null ||
  skip "OGRE 1.12 is not installed (libogre-1.12-dev)"
command -v xvfb-run > /dev/null || skip "no xvfb-run (xvfb, xauth)"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if ! { cmake --install "$build" --prefix "$work/limber" &&
  cmake -S "$here/host" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/limber" \
    -DCMAKE_BUILD_TYPE=Release &&
  cmake --build "$work/build" --parallel 2; } > "$work/log" 2>&1; then
  cat "$work/log"
  exit 1
fi

# A server number of its own: two xvfb-run that look for a free one at once can take the same.
on_no_screen() {
  LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -n $((200 + $$ % 800)) -s '-screen 0 640x480x24' "$@"
}

# drag NAME: pictures of the character's own script, and what the host and OGRE say of it.
drag() {
  local name=$1 pictures=$build/tests/runtime/ogre/$1 found
  rm -rf "$pictures"
  mkdir -p "$pictures"
  "$work/limber/bin/limber" bake "$content/$name.glb" -o "$work/$name.glb" --quiet
  # The program's own words come from stdout: xvfb-run puts stderr there as well.
  on_no_screen "$work/build/ogre_host" "$work/$name.glb" "$content/${name}_drag.json" "$pictures" \
    > "$work/said" || { cat "$work/said"; fail "$name: the host found the above"; }
  # OGRE draws on where a shader or a texture failed; only its log tells.
  if grep -iE 'error|exception|failed|cannot' "$pictures/ogre.log" | grep -v 'EXTENSIONS ='; then
    fail "$name: OGRE was not content"
  fi
  found=$(cksum "$pictures"/*.png | awk '{ print $1 }' | sort -u | wc -l)
  [[ $found -eq $num_pictures ]] || fail "$name: $found different pictures of $num_pictures"
  printf 'ogre: %s: %s\n' "$name" "$(cat "$work/said")"
}

drag dragonlet
drag fox
