#!/usr/bin/env bash
# From a bare machine to a dragged character: sets up, builds, bakes the shipped characters, drags
# each along its scripted path, renders the frames without a window, and names what it wrote.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
# shellcheck source=setup.sh
. ./setup.sh

usage() {
  cat <<'TEXT'
Usage: ./demo.sh [--size WxH] [CHARACTER]...

Installs what is missing (setup.sh), builds the limber command, then for each character:
bakes content/characters/CHARACTER.glb, drags it along CHARACTER_drag.json, renders every frame
on whatever Vulkan device there is (Mesa's software device where there is no GPU).

Without a name: all shipped characters. Writes demo_output/: the baked files, the frames as PNG, a
contact sheet and a short film of each, and prints the ms per frame of each stage.
TEXT
}

size=960x720 characters=()
while [[ $# -gt 0 ]]; do
  case "$1" in
    --size=*) size=${1#*=} ;;
    --size)
      size=${2:-}
      [[ $# -gt 1 ]] && shift
      ;;
    -h | --help) usage; exit 0 ;;
    -*) usage >&2; exit 2 ;;
    *) characters+=("$1") ;;
  esac
  shift
done

limber=build/release/bin/limber
output=demo_output
wrote=()

build() {
  mkdir -p build
  if ! cmake --preset release > build/release.configure.log 2>&1; then
    cat build/release.configure.log >&2
    fail "the configuration failed (see above)"
  fi
  cmake --build --preset release --target limber_command
}

# A dozen frames spread over the path on one sheet.
contact_sheet() {
  local frames=("$1"/frame_*.png) chosen=() i
  for ((i = 0; i < 12; ++i)); do
    chosen+=("${frames[i * (${#frames[@]} - 1) / 11]}")
  done
  montage "${chosen[@]}" -resize 480x -tile 4x3 -geometry +4+4 -background '#20242c' -depth 8 "$2"
  wrote+=("$2")
}

# The frames as a film, in the best form that the machine can write.
film() {
  local frames=("$1"/frame_*.png)
  if have ffmpeg && ffmpeg -loglevel error -y -framerate 30 -i "$1/frame_%04d.png" \
      -pix_fmt yuv420p -vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' "$2.mp4"; then
    wrote+=("$2.mp4")
  elif convert -list format | grep -q '^ *WEBP\* .*rw'; then
    convert -delay 3.3 -loop 0 "${frames[@]}" -resize 640x -quality 80 "$2.webp"
    wrote+=("$2.webp")
  else
    convert -delay 4 -loop 0 "${frames[@]}" -resize 480x -layers optimize "$2.gif"
    wrote+=("$2.gif")
  fi
}

run_character() {
  local name=$1 source=content/characters/$1.glb handles=()
  [[ -f $source ]] || fail "there is no character $source"
  [[ -f content/characters/${name}_handles.json ]] &&
    handles=(--handles "content/characters/${name}_handles.json")
  printf '\n== %s\n' "$name"
  "$limber" bake "$source" -o "$output/${name}_baked.glb" "${handles[@]}"
  rm -rf "${output:?}/$name"
  "$limber" render "$output/${name}_baked.glb" --targets "content/characters/${name}_drag.json" \
    -o "$output/$name" --size "$size" --dots
  wrote+=("$output/$name/frame_0000.png ...")
  if have montage && have convert; then
    contact_sheet "$output/$name" "$output/${name}_sheet.png"
    film "$output/$name" "$output/$name"
  else
    say "no ImageMagick: no contact sheet and no film, the frames are there"
  fi
}

setup_main --for demo
pin_software_vulkan
build
if [[ ${#characters[@]} -eq 0 ]]; then
  for path in content/characters/*_drag.json; do
    [[ -f $path ]] || fail "content/characters holds no character with a _drag.json"
    path=${path##*/}
    characters+=("${path%_drag.json}")
  done
fi
mkdir -p "$output"
for character in "${characters[@]}"; do
  run_character "$character"
done

printf '\nWritten:\n'
printf '  %s\n' "${wrote[@]}"
printf 'Drag one yourself: %s play %s/%s_baked.glb\n' "$limber" "$output" "${characters[0]}"
