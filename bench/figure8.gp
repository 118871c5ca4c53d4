# The plot of figure8.sh: error of the tip against degrees of freedom and against time. Needs csv, format and picture.
if (format eq "svg") set terminal svg size 1200,580 font "Helvetica,14" background "white"; else \
  set terminal pngcairo size 1200,580 font "Sans,11" background "white"
set output picture
set datafile separator ","

array name[6] = ["rigid frames", "affine frames", "linear tetrahedra", "quadratic tetrahedra", "linear hexahedra", \
  "quadratic hexahedra"]
array color[6] = ["#0b4f9e", "#3fa0e0", "#c2410c", "#c2410c", "#15803d", "#15803d"]
array mark[6] = [5, 4, 6, 7, 8, 9]
array dash[6] = [1, 1, 2, 1, 2, 1]

set logscale xy
set format y "%g"
set grid xtics ytics lt 1 lw 1 lc rgb "#dddddd"
set ylabel "error of the tip's drop [%]"
set yrange [0.01:100]
set multiplot layout 1,2 margins 0.07,0.98,0.21,0.93 spacing 0.09 \
  title "Soft cantilever, 16 x 1 x 1 m, 40 kPa, 5 kg, under its own weight: drop 6.5096 m"
of(k, column_number) = strcol(1) eq name[k] ? column(column_number) : NaN

set key at screen 0.5,0.01 center bottom maxrows 2 width 2
set xlabel "degrees of freedom"
set format x "10^{%L}"
set label 1 "uncertainty of the reference" at graph 0.02, first 0.019 font ",10" textcolor rgb "#777777"
plot for [k=1:6] csv using (of(k, 3)):(abs(of(k, 6))) with linespoints lc rgb color[k] pt mark[k] \
    dt dash[k] lw 1.8 ps 1.1 title name[k], \
  0.023 with lines lc rgb "#777777" dt 3 notitle
unset key
unset label 1
set xlabel "solve, one thread [ms]"
plot for [k=1:6] csv using (of(k, 7)):(abs(of(k, 6))) with linespoints lc rgb color[k] pt mark[k] \
    dt dash[k] lw 1.8 ps 1.1 notitle, \
  0.023 with lines lc rgb "#777777" dt 3 notitle
unset multiplot
