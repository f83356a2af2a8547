# shellcheck shell=bash
# What the scripts beside it begin with (source it, with their arguments): $top and $here are folders,
# $limber the program, $work a folder that goes when the script ends, with the baked dragonlet in it.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
top=$(cd "$here/../.." && pwd)
limber=${1:-$top/build/release/bin/limber}
[[ -x $limber ]] || { echo "$limber: not found; build it first, or name it" >&2; exit 1; }
command -v convert > /dev/null || { echo "convert: not found; install ImageMagick" >&2; exit 1; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$limber" -q bake "$top/content/characters/dragonlet.glb" -o "$work/dragonlet.glb"
