#!/usr/bin/env bash
# Makes content/pictures/inspect.png, the README's picture of `limber inspect`: the dragonlet's edge
# groups, the weights of its belly, and the examples in a dragged pose of overview.png. ImageMagick
# lays them out.
#
#   content/pictures/make_inspect.sh [LIMBER]        default: build/release/bin/limber
# shellcheck source=content/pictures/begin.sh
source "$(dirname "${BASH_SOURCE[0]}")/begin.sh" "$@"

# Twice the size that is needed, for smooth edges.
inspect() {
  "$limber" -q inspect "$work/dragonlet.glb" -o "$work" --size 960x840 --yaw -12 "$@"
}
inspect --zoom 1.25 --what groups,weights --handle belly
inspect --zoom 1.15 --what examples --targets "$here/overview_dragged.json" --frame 15

convert "$work/weights_belly.png" "$work/groups.png" "$work/examples.png" -resize 50% \
  -bordercolor white -border 4x0 +append -shave 4x0 \
  -strip -define png:compression-level=9 "$work/inspect.png"
mv "$work/inspect.png" "$here/inspect.png"
echo "$here/inspect.png"
