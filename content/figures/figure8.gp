# Figure 8: -e "folder='...'; output='...'". Data: x and three weights a line, block 0 the way out,
# block 1 the way back.
set terminal pngcairo size 1500,960 font 'DejaVu Sans,15' background '#ffffff'
set output output
red = '#d8392f'; green = '#2f9e44'; blue = '#2f62d8'
set multiplot layout 2,2 margins 0.062,0.985,0.075,0.845 spacing 0.06,0.13
set xrange [0.6:3]
set yrange [-0.03:1.06]
set xtics ('0.6' 0.6, '1' 1, '1.6' 1.6, '2' 2, '2.4' 2.4, '3' 3) nomirror
set ytics 0.25 nomirror
set border 3 lc rgb '#555555'
set tics textcolor rgb '#333333'
unset key
# Where the handle is in each example.
set for [x in '1 1.6 2.4'] arrow from x+0,-0.03 to x+0,1 nohead lc rgb '#bbbbbb' back
panels = 'a b c d'
titles = "'without rotations, λ = 0.5' 'without rotations, λ = 10' ". \
  "'without rotations, λ = 0.01' 'with rotations, λ = 0.5'"
colours = red.' '.green.' '.blue
pale = '#f3b1ac #a9dbb3 #aec2f5'
set label 1 'Average of B over the edge groups, against the position of the right handle' \
  at screen 0.03,0.967 font 'DejaVu Sans,19' textcolor rgb '#222222'
set label 2 '■ square' at screen 0.03,0.925 textcolor rgb red
set label 3 '■ puffed' at screen 0.103,0.925 textcolor rgb green
set label 4 '■ thinned' at screen 0.176,0.925 textcolor rgb blue
set label 5 'wide and pale: dragged outwards; thin and dark: dragged back; '. \
  'grey: where an example has it' \
  at screen 0.262,0.925 textcolor rgb '#555555'
do for [i = 1:4] {
  set title word(titles, i) offset 0,-0.4 font 'DejaVu Sans,17' textcolor rgb '#222222'
  if (i > 2) { set xlabel 'x of the right handle' offset 0,0.3 } else { unset xlabel }
  unset ylabel  # the title says it
  file = sprintf('%s/figure8%s.txt', folder, word(panels, i))
  plot for [s = 1:3] file index 0 using 1:s+1 with lines lw 7 lc rgb word(pale, s), \
       for [s = 1:3] file index 1 using 1:s+1 with lines lw 1.8 lc rgb word(colours, s)
  unset label
}
unset multiplot
