# The graph beside one row of figure 2: -e "data='...'; output='...'". Data: time, three weights.
set terminal pngcairo size 400,170 font 'DejaVu Sans,12' background '#ffffff'
set output output
set lmargin 6.5
set rmargin 1
set tmargin 0.6
set bmargin 2
set xrange [1:9]
set yrange [-0.04:1.04]
set xtics 1,1 nomirror scale 0.6
set ytics ('0' 0, '½' 0.5, '1' 1) nomirror scale 0.6
set border 3 lc rgb '#555555'
set tics textcolor rgb '#333333'
set grid xtics lc rgb '#dddddd' lt 1
unset key
plot data using 1:2 with lines lw 2.6 lc rgb '#d8392f', \
     data using 1:3 with lines lw 2.6 lc rgb '#2f9e44', \
     data using 1:4 with lines lw 2.6 lc rgb '#2f62d8'
