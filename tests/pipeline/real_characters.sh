#!/usr/bin/env bash
# Pictures of the drags that the accuracy tests made of the real characters: after
#     ctest --test-dir build/release -L data -R Accuracy
# this renders what they kept and lays out one contact sheet a character. The characters may not be
# redistributed, so neither may the pictures: they stay in the build folder.
set -euo pipefail
build=${1:-build/release}
limber=$PWD/$build/bin/limber
cd "$build/pictures"
for frames in *.json; do
  name=${frames%.json}
  "$limber" render "$name.glb" --targets "$frames" -o "$name" --size 480x480 --dots
  mapfile -t pictures < <(printf '%s\n' "$name"/frame_*.png | awk 'NR % 10 == 5')
  montage "${pictures[@]}" -tile 5x -geometry 300x300+2+2 "${name}_sheet.png"
  printf '%s\n' "$build/pictures/${name}_sheet.png"
done
