# `limber info --json` of a baked character -> frames that take each handle from rest to where an
# example shape has it, on a straight line. -v choice="EXAMPLE HANDLE=EXAMPLE ...": the example of
# all handles, and of single ones (a name may end in *). -v steps=N
function shape_number(name,   s) {
  for (s = 1; s <= num_shapes; ++s) if (shapes[s] == name) return s
  printf "no example shape %s\n", name > "/dev/stderr"
  exit failed = 1
}
function example_of(handle,   i, pair, found) {
  found = shape_number(choices[1])
  for (i = 2; i <= num_choices; ++i) {
    split(choices[i], pair, "=")
    if (handle == pair[1] ||
        (pair[1] ~ /\*$/ && index(handle, substr(pair[1], 1, length(pair[1]) - 1)) == 1))
      found = shape_number(pair[2])
  }
  return found
}
BEGIN { RS = "^$" }
{
  gsub(/[ \n]/, "")
  match($0, /"shapes":\[[^\]]*\]/)
  list = substr($0, RSTART + 10, RLENGTH - 11)
  gsub(/"/, "", list)
  num_shapes = split(list, shapes, ",")
  num_choices = split(choice, choices, " ")
  num_handles = split($0, handles, /\{"name":"/) - 1
  for (step = 1; step <= steps; ++step) frames[step] = ""
  for (h = 2; h <= num_handles + 1; ++h) {
    if (handles[h] !~ /"pinned":true/) continue
    if (!first) first = h
    name = substr(handles[h], 1, index(handles[h], "\"") - 1)
    at = index(handles[h], "\"examples\":[[") + 13
    list = substr(handles[h], at)
    split(substr(list, 1, index(list, "]]") - 1), positions, /\],\[/)
    split(positions[1], from, ",")
    split(positions[example_of(name)], to, ",")
    for (step = 1; step <= steps; ++step) {
      t = step / steps
      frames[step] = frames[step] sprintf("%s\"%s\":[%.7g,%.7g,%.7g]", (h > first ? "," : ""), name,
        from[1] + t * (to[1] - from[1]), from[2] + t * (to[2] - from[2]),
        from[3] + t * (to[3] - from[3]))
    }
  }
  for (step = 1; step <= steps; ++step)
    printf "%s{\"targets\":{%s}}", step == 1 ? "{\"frames\":[" : ",\n", frames[step]
  print "]}"
}
END { exit failed }
