#!/usr/bin/env bash
# Makes content/pictures/overview.png, the picture at the top of the README: the dragonlet's rest
# shape, some of its example shapes, and two poses that none of them shows, dragged by its handles.
# Every figure is rendered by limber itself; ImageMagick lays them out.
#
#   content/pictures/make_overview.sh [LIMBER]        default: build/release/bin/limber
#
# The targets lie beside this script: every pose is reached from the one before in a few frames.
# shellcheck source=content/pictures/begin.sh
source "$(dirname "${BASH_SOURCE[0]}")/begin.sh" "$@"

# render NAME TARGETS SIZE ZOOM OPTIONS...: twice the size that is needed, for smooth edges.
render() {
  "$limber" -q render "$work/dragonlet.glb" --targets "$here/$2" -o "$work/$1" --size "$3" \
    --zoom "$4" --yaw -12 --iterations 6 "${@:5}"
}
render rest overview_examples.json 688x1160 1.7 --dots
render examples overview_examples.json 344x372 1.15
render dragged overview_dragged.json 792x1160 1.25 --dots

# card PICTURE WIDTH HEIGHT OUT: shrunk, with round corners.
card() {
  convert "$1" -resize "$2x$3!" \
    \( -size "$2x$3" xc:black -fill white -draw "roundrectangle 0,0,$(($2 - 1)),$(($3 - 1)),12,12" \) \
    -alpha off -compose CopyOpacity -composite "$4"
}

# The last frame of each pose: examples take 6 frames, dragged poses 8.
card "$work/rest/frame_0005.png" 344 580 "$work/rest.png"
card "$work/dragged/frame_0007.png" 396 580 "$work/dragged_0.png"
card "$work/dragged/frame_0015.png" 396 580 "$work/dragged_1.png"

font=(-family Helvetica -fill '#3c4650')
layout=("$work/rest.png" -geometry +28+88 -composite
  "$work/dragged_0.png" -geometry +768+88 -composite
  "$work/dragged_1.png" -geometry +1176+88 -composite)
labels=(-pointsize 27 -annotate +30+62 'Example shapes' -annotate +770+62 'Dragged by its handles'
  -pointsize 15 -fill '#6b7681' -annotate +40+112 'rest')
names=(squash stretch puff curl lean wave)
for i in {0..5}; do
  frame=$(printf '%s/examples/frame_%04d.png' "$work" $((6 * (i + 2) - 1)))
  row=$((i / 2))
  x=$((384 + i % 2 * 184)) y=$((88 + row * 197))
  card "$frame" 172 186 "$work/example_$i.png"
  layout+=("$work/example_$i.png" -geometry "+$x+$y" -composite)
  labels+=(-annotate "+$((x + 12))+$((y + 24))" "${names[i]}")
done

convert -size 1600x700 xc:'#f6f6f4' "${layout[@]}" "${font[@]}" "${labels[@]}" \
  -strip -define png:compression-level=9 "$work/overview.png"
mv "$work/overview.png" "$here/overview.png"
echo "$here/overview.png"
