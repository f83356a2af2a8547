#!/usr/bin/env bash
# Makes figures 2, 7 and 8 of Wampler 2016 from the shipped characters. README.md says what one
# sees in them; tests/pipeline/figures_test.cpp asserts it.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
here=$top/content/figures
pictures=$top/content/pictures

usage() {
  cat <<'TEXT'
Usage: content/figures/make_figures.sh [OPTIONS] [2|7|8]...

Makes content/pictures/figure2.png, figure7.png and figure8.png: all three, or the ones named.

  --limber FILE   the command (default build/release/bin/limber)
  --data DIR      also figure 7 of the paper's own horse and lion, DIR/horse/*.obj and
                  DIR/characters/lion-poses.glb, into build/figures: they may not be redistributed
  --help          this text
TEXT
}

fail() {
  printf 'make_figures: %s\n' "$*" >&2
  exit 1
}

limber=$top/build/release/bin/limber data='' figures=()
while [[ $# -gt 0 ]]; do
  case "$1" in
    --limber | --data)
      [[ $# -gt 1 ]] || { usage >&2; exit 2; }
      declare "${1#--}=$2"
      shift
      ;;
    -h | --help) usage; exit 0 ;;
    2 | 7 | 8) figures+=("$1") ;;
    *) usage >&2; exit 2 ;;
  esac
  shift
done
[[ ${#figures[@]} -gt 0 ]] || figures=(2 7 8)

check_tools() {
  local missing=()
  command -v gnuplot > /dev/null || missing+=(gnuplot-nox)
  command -v convert > /dev/null || missing+=(imagemagick)
  [[ ${#missing[@]} -eq 0 ]] ||
    fail "missing: ${missing[*]} (Debian: apt-get install --no-install-recommends ${missing[*]})"
  [[ -x $limber ]] || fail "$limber: not found; build it (target limber_command) or name it"
  [[ -z $data || -d $data ]] || fail "$data: no such folder"
}
check_tools

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
font=(-family 'DejaVu Sans')

# bake NAME [SOURCE OPTIONS...]: $work/NAME.glb, once.
bake() {
  [[ -f $work/$1.glb ]] ||
    "$limber" -q bake "${2:-$top/content/characters/$1.glb}" -o "$work/$1.glb" "${@:3}"
}

# publish PICTURE FILE: whole or not at all.
publish() {
  mkdir -p "$(dirname "$2")"
  cp "$1" "$2.new"
  mv "$2.new" "$2"
  printf '%s\n' "$2"
}

# The numbers on standard input, one a line, as the x of the square's right handle.
square_frames() {
  awk 'BEGIN { print "{\"frames\":[" }
    { printf "%s{\"targets\":{\"right\":[%.6f,0,0]}}", (NR > 1 ? ",\n" : ""), $1 }
    END { print "]}" }'
}

# The largest change of a weight from line to line of a table (x and three weights).
largest_step() {
  awk 'NF == 0 { n = 0; next }
    n++ { for (s = 2; s <= 4; ++s) { d = $s - last[s]; if (d < 0) d = -d; if (d > most) most = d } }
    { for (s = 2; s <= 4; ++s) last[s] = $s }
    END { printf "%.2f", most }' "$1"
}

# Figure 2: the square stretched and un-stretched over time under four energies; the curves of the
# weights beside nine of the poses, each in the mix of its weights' colours.

row_height=170 graph_width=400 strip_width=1150
half_frames=80   # from rest to the widest; nine poses, so a multiple of 4
scale=31%        # of the renderings
pixels=62.5      # then, of a unit of length
gap=26           # between poses
width=$((graph_width + 20 + strip_width))

# tint PICTURE R G B OUT: the rendered square cut out of its background, its texture's shades
# in the mix of the three colours.
tint() {
  local colour
  colour=$(awk -v r="$2" -v g="$3" -v b="$4" 'BEGIN {
    printf "rgb(%d,%d,%d)", 226 * r + 62 * g + 62 * b, 66 * r + 172 * g + 112 * b,
      56 * r + 84 * g + 226 * b }')
  # The background is grey, the square is not.
  convert "$1" -alpha off -colorspace HSB -channel G -separate +channel -threshold 20% \
    "$work/mask.png"
  convert \( "$1" -alpha off -colorspace Gray -level 0%,92% -colorspace sRGB -type TrueColor \
      \( -clone 0 -fill "$colour" -colorize 100 \) -compose Multiply -composite \
      \( "$1" -alpha off -colorspace Gray -colorspace sRGB -evaluate multiply 0.22 \) \
      -compose Plus -composite \) "$work/mask.png" -alpha off -compose CopyOpacity -composite \
    -trim +repage -background white -alpha remove -resize "$scale" "$5"
}

# The widths of the nine poses' places in the strip.
slots() {
  awk -v pixels="$pixels" -v gap="$gap" 'BEGIN {
    for (i = 0; i <= 8; ++i) printf "%d\n", pixels * (1 + 0.35 * (i < 4 ? i : 8 - i)) + gap }'
}

# row LETTER TITLE OPTIONS...: $work/row_LETTER.png.
row() {
  local letter=$1 title=$2 i frame weights slots cards=() options=(--iterations 100 "${@:3}")
  read -r -d '' -a slots <<< "$(slots)" || true
  "$limber" -q solve "$work/square.glb" --targets "$work/stretch.json" -o "$work/solve_$letter" \
    "${options[@]}"
  "$limber" -q render "$work/square.glb" --targets "$work/stretch.json" -o "$work/render_$letter" \
    --size 560x420 "${options[@]}"
  awk -f "$here/weights.awk" "$work/solve_$letter/solve.json" |
    awk -v n="$half_frames" '{ print 1 + 4 * $1 / n, $2, $3, $4 }' > "$work/figure2$letter.txt"
  gnuplot -e "data='$work/figure2$letter.txt'; output='$work/graph.png'" "$here/figure2.gp"
  for i in {0..8}; do
    frame=$((i * half_frames / 4))
    read -r -a weights <<< "$(sed -n "$((frame + 1))p" "$work/figure2$letter.txt")"
    tint "$work/render_$letter/frame_$(printf %04d "$frame").png" "${weights[@]:1:3}" \
      "$work/card.png"
    convert "$work/card.png" -background white -gravity center -extent "${slots[i]}x$row_height" \
      "$work/card_$i.png"
    cards+=("$work/card_$i.png")
  done
  convert "${cards[@]}" +append "$work/strip.png"
  convert -size "${width}x$((row_height + 30))" xc:white \
    "$work/graph.png" -geometry +0+30 -composite \
    "$work/strip.png" -geometry "+$((graph_width + 20))+24" -composite \
    "${font[@]}" -pointsize 18 -fill '#222222' -annotate +12+20 "$letter)  $title" \
    "$work/row_$letter.png"
  printf '  figure 2%s: largest step of a curve between two frames %s (%s)\n' "$letter" \
    "$(largest_step "$work/figure2$letter.txt")" "$title"
}

# The three examples at the head, as in figure 1: frames in which the handle is where they have it.
examples() {
  local i
  printf '%s\n' 1 1.6 2.4 | square_frames > "$work/examples.json"
  "$limber" -q render "$work/square.glb" --targets "$work/examples.json" -o "$work/examples" \
    --size 560x420 --iterations 100
  for i in 0 1 2; do
    tint "$work/examples/frame_000$i.png" $((i == 0)) $((i == 1)) $((i == 2)) "$work/example_$i.png"
  done
}

figure2() {
  local slots numbers=() left=$((graph_width + 20)) i
  bake square
  examples
  awk -v n="$half_frames" 'BEGIN {
    for (i = 0; i <= 2 * n; ++i) print 1 + 1.4 * (i < n ? i : 2 * n - i) / n }' |
    square_frames > "$work/stretch.json"
  row a 'Ours, without rotations' --no-rotations
  row b 'Ours, with rotations'
  row c 'Energy interpolation (eq. 2): the nearest example alone' --uniform --no-roots \
    --lambda 1000000
  row d 'Linear shape space (λ = 0)' --no-rotations --uniform --lambda 0
  read -r -d '' -a slots <<< "$(slots)" || true
  for i in {0..8}; do
    numbers+=(-annotate "+$((left + slots[i] / 2 - 5))+0" "$((i + 1))")
    left=$((left + slots[i]))
  done
  convert -size "${width}x120" xc:white "${font[@]}" -fill '#222222' \
    -pointsize 22 -annotate +12+36 'A square with three examples, stretched and un-stretched' \
    -pointsize 15 -fill '#555555' \
    -annotate +12+66 'Left: blend weights, averages over the edge groups, of the nine numbered' \
    -annotate +12+88 "poses and between them. Right: the poses, in a mix of the examples' colours." \
    -pointsize 18 -fill '#222222' -annotate "+$((width - 520))+66" 'Examples' \
    \( "$work"/example_[012].png -bordercolor white -border 14x0 -gravity center +append \) \
    -gravity east -geometry +20+0 -composite "$work/head.png"
  convert -size "${width}x26" xc:white "${font[@]}" -pointsize 15 \
    -fill '#333333' -gravity northwest "${numbers[@]}" "$work/foot.png"
  convert "$work"/head.png "$work"/row_[abcd].png "$work/foot.png" -append -strip \
    -define png:compression-level=9 "$work/figure2.png"
  publish "$work/figure2.png" "$pictures/figure2.png"
}

# Figure 8: the average of B over the groups against the right handle's x, out
# and back, every pose settled. The paper's four panels.

# sweep PANEL OPTIONS...: $work/figure8PANEL.txt.
sweep() {
  local folder=$work/sweep$1
  "$limber" -q solve "$work/square.glb" --targets "$work/sweep.json" -o "$folder" --iterations 150 \
    "${@:2}"
  # The first 41 frames only lead to the sweep's beginning.
  awk -f "$here/weights.awk" "$folder/solve.json" | paste -d ' ' "$work/sweep.txt" - |
    awk 'NR == 282 { print "\n" } NR > 41 { print $1, $3, $4, $5 }' > "$work/figure8$1.txt"
  printf '  figure 8%s: largest step of a curve for 0.01 of the handle %s (%s)\n' "$1" \
    "$(largest_step "$work/figure8$1.txt")" "${*:2}"
}

figure8() {
  bake square
  awk 'BEGIN {
    for (i = 0; i <= 40; ++i) print 1 - i / 100
    for (i = 1; i <= 240; ++i) print 0.6 + i / 100
    for (i = 0; i <= 240; ++i) print 3 - i / 100
  }' > "$work/sweep.txt"
  square_frames < "$work/sweep.txt" > "$work/sweep.json"
  sweep a --no-rotations --lambda 0.5
  sweep b --no-rotations --lambda 10
  sweep c --no-rotations --lambda 0.01
  sweep d --lambda 0.5
  gnuplot -e "folder='$work'; output='$work/figure8.png'" "$here/figure8.gp"
  publish "$work/figure8.png" "$pictures/figure8.png"
}

# Figure 7: blend weights that vary over the character against one blend for all of it, where two
# parts want two examples.

# The handles go where the examples have them in this many frames.
steps=8

# card PICTURE WIDTH HEIGHT [LABEL] OUT: shrunk, the label below it.
card() {
  local label=()
  [[ $# -lt 5 ]] || label=(-background white -gravity south -splice 0x26 "${font[@]}" -pointsize 15
    -fill '#3c4650' -gravity southwest -annotate +2+7 "$4")
  convert "$1" -resize "$2x$3!" "${label[@]}" "${@: -1}"
}

# pose CHARACTER CHOICE NAME SIZE OPTIONS...: $work/NAME.png, the pose after the drag to CHOICE (see
# examples_drag.awk).
pose() {
  "$limber" info --json "$work/$1.glb" |
    awk -v steps="$steps" -v choice="$2" -f "$here/examples_drag.awk" > "$work/pose.json"
  "$limber" -q render "$work/$1.glb" --targets "$work/pose.json" -o "$work/pose" --size "$4" \
    --iterations 30 "${@:5}"
  mv "$work/pose/frame_$(printf %04d $((steps - 1))).png" "$work/$3.png"
  rm -r "$work/pose"
}

# pair CHARACTER CHOICE OUT OPTIONS...: the pose both ways, side by side.
pair() {
  pose "$1" "$2" varying 840x800 --dots "${@:4}"
  pose "$1" "$2" uniform 840x800 --dots --uniform "${@:4}"
  card "$work/varying.png" 420 400 "$work/varying_card.png"
  card "$work/uniform.png" 420 400 "$work/uniform_card.png"
  convert "$work/varying_card.png" \( "$work/uniform_card.png" -background white -gravity west \
    -splice 12x0 \) +append "$3"
}

# comparison CHARACTER CHOICE ONE LABEL_ONE OTHER LABEL_OTHER OUT OPTIONS...: the two examples and
# the pair.
comparison() {
  local character=$1 choice=$2 out=$7 options=("${@:8}")
  pose "$character" "$3" one 416x348 "${options[@]}"
  pose "$character" "$5" other 416x348 "${options[@]}"
  card "$work/one.png" 208 174 "$4" "$work/one_card.png"
  card "$work/other.png" 208 174 "$6" "$work/other_card.png"
  pair "$character" "$choice" "$work/pair.png" "${options[@]}"
  convert \( "$work/one_card.png" "$work/other_card.png" -append \) \
    \( "$work/pair.png" -background white -gravity west -splice 12x0 \) \
    -background white -gravity north +append "$out"
}

# sheet OUT LEFT ROW...: the rows below the columns' titles; LEFT: where the pairs begin.
sheet() {
  local examples=()
  [[ $2 -eq 0 ]] || examples=(-annotate +0+28 'Examples')
  convert -size "$(($2 + 852))x44" xc:white "${font[@]}" -fill '#222222' -pointsize 18 \
    "${examples[@]}" -annotate "+$2+28" 'Each part with a blend of its own' \
    -annotate "+$(($2 + 432))+28" 'One blend for the whole character' "$work/titles.png"
  convert "$work/titles.png" \( "${@:3}" -background white -gravity south -splice 0x12 \) -append \
    -bordercolor white -border 16x6 -strip -depth 8 -define png:compression-level=9 "$1"
}

figure7() {
  bake fox
  bake dragonlet
  comparison fox 'base head=stretch tail_tip=curl' \
    stretch 'head: stretch' curl 'tail: curl' "$work/figure7_0.png" --zoom 1.1
  comparison fox 'base head=bend_left hand_*=bend_left tail_tip=curl' \
    bend_left 'head, hands: bend left' curl 'tail: curl' "$work/figure7_1.png" --zoom 1.02
  comparison dragonlet 'squash head=stretch nose=stretch ear_*=stretch hand_*=stretch' \
    stretch 'head, hands: stretch' squash 'the rest: squash' "$work/figure7_2.png" \
    --zoom 1.2 --yaw -12
  sheet "$work/figure7.png" 220 "$work"/figure7_[012].png
  publish "$work/figure7.png" "$pictures/figure7.png"
}

# Every leg from another example, as in the paper.
figure7_of_data() {
  "$limber" -q pack "$data"/horse/horse_ref.obj "$data"/horse/horse-0[1235].obj -o "$work/poses.glb"
  bake horse "$work/poses.glb" --auto-handles 14
  bake lion "$data/characters/lion-poses.glb" --auto-handles 14
  pair horse 'base handle_1=horse-01 handle_6=horse-05 handle_5=horse-02 handle_2=horse-05' \
    "$work/data_0.png" --yaw 70 --zoom 1.15
  pair lion \
    'base handle_1=lion-01 handle_5=lion-03 handle_2=lion-03 handle_3=lion-03 handle_0=lion-01' \
    "$work/data_1.png" --yaw 70 --zoom 1.15
  sheet "$work/figure7_data.png" 0 "$work"/data_[01].png
  publish "$work/figure7_data.png" "$top/build/figures/figure7_data.png"
}

for figure in "${figures[@]}"; do
  "figure$figure"
done
[[ -z $data ]] || figure7_of_data
