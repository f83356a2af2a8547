#!/bin/bash
# One run of the player under a virtual screen: started by play_window_test, inside xvfb-run.
#   play_session.sh HOST CHARACTER FOLDER SCENARIO
# SCENARIO is a file of calls of the functions below. Pictures of the screen go to FOLDER, what the
# player said to FOLDER/log; the exit code is the player's, or 90 and above for this script's own.
host=$1 character=$2 folder=$3 scenario=$4
lavapipe=/usr/share/vulkan/icd.d/lvp_icd.$(uname -m).json
if [ -z "$VK_ICD_FILENAMES" ] && [ -f "$lavapipe" ]; then export VK_ICD_FILENAMES=$lavapipe; fi

fail() {
  echo "play_session: $2" >> "$folder/log"
  kill "$player" 2>/dev/null
  exit "$1"
}

# shot NAME [OTHER]: the screen as FOLDER/NAME.png, once there is something on it, it differs from
# OTHER's and has stood still for three looks.
declare -A seen=([none]=none)
look() { import -window root -depth 8 "rgb:$folder/screen.rgb" && md5sum < "$folder/screen.rgb"; }
shot() {
  local last=none still=0 now
  for _ in $(seq 150); do
    sleep 0.1
    now=$(look)
    if [ "$now" = "$last" ] && [ "$now" != "$blank" ] && [ "$now" != "${seen[${2:-none}]}" ]; then
      still=$((still + 1))
    else
      still=0
    fi
    last=$now
    if [ $still -eq 2 ]; then
      seen[$1]=$now
      convert -size 800x600 -depth 8 "rgb:$folder/screen.rgb" "$folder/$1.png" && return
    fi
  done
  fail 91 "the screen never changed and stood still for $1"
}

# drag BUTTON X0 Y0 X1 Y1: button down, over in steps, button up.
drag() {
  xdotool mousemove "$2" "$3" sleep 0.1 mousedown "$1" sleep 0.1
  for i in $(seq 10); do
    xdotool mousemove $(($2 + ($4 - $2) * i / 10)) $(($3 + ($5 - $3) * i / 10)) sleep 0.02
  done
  xdotool sleep 0.1 mouseup "$1"
}

hover() { xdotool mousemove "$1" "$2"; }
scroll_in() { xdotool click 4; }
key() { xdotool key "$1"; }
resize() { xdotool windowsize "$window" "$1" "$2"; }
hide_and_show() { xdotool windowunmap "$window" sleep 0.3 windowmap "$window"; }

blank=$(look)
"$host" "$character" 2> "$folder/log" &
player=$!
window=$(timeout 30 xdotool search --sync --onlyvisible --pid "$player" --name limber | head -1)
[ -n "$window" ] || fail 90 "no window appeared"
xdotool windowmove "$window" 0 0
# shellcheck source=/dev/null
. "$scenario"
xdotool key Escape
for _ in $(seq 100); do
  kill -0 "$player" 2>/dev/null || break
  sleep 0.1
done
kill -0 "$player" 2>/dev/null && fail 92 "Escape did not close the window"
wait "$player"
