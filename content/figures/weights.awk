# solve.json of `limber solve` -> a line a frame: frame, mean blend weight of each shape over the
# edge groups.
BEGIN { RS = "\"blend_weights\":" }
NR > 1 {
  gsub(/[ \n]/, "")
  num_groups = split(substr($0, 3, index($0, "]]") - 3), groups, /\],\[/)
  for (g = 1; g <= num_groups; ++g) {
    num_shapes = split(groups[g], weights, ",")
    for (s = 1; s <= num_shapes; ++s) sum[s] = (g == 1 ? 0 : sum[s]) + weights[s]
  }
  line = NR - 2
  for (s = 1; s <= num_shapes; ++s) line = line sprintf(" %.6f", sum[s] / num_groups)
  print line
}
