# The plot of table3.sh: time of a step by integration points. Needs csv, format, picture and setting.
if (format eq "svg") set terminal svg size 900,600 font "Helvetica,14" background "white"; else \
  set terminal pngcairo size 900,600 font "Sans,11" background "white"
set output picture
set datafile separator ","
set datafile missing NaN   # lines run on where a row is of another series
set logscale xy
set format x "10^{%L}"
set format y "%g"
set grid xtics ytics lt 1 lw 1 lc rgb "#dddddd"
set xlabel "integration points, 4 neighbours each"
set ylabel "time step of 60 CG iterations [ms]"
set key left top
set title "Bosman, Duriez and Cotin 2014, table 3"

# Columns of the CSV: 3 setting, 4 points, 8 backend, 9 threads, 11 step_ms, 17 and 18 the paper's.
ours(backend, several, value) = strcol(3) eq setting && strcol(8) eq backend && \
  (backend eq "cuda" ? column(19) == 1 : several ? column(9) > 1 : column(9) == 1) ? value : NaN
there(backend) = int(system(sprintf("grep -c ',%s,' '%s'; true", backend, csv))) > 0
plot csv using 4:(ours("cpu", 0, column(17))) with linespoints lc rgb "#999999" pt 6 dt 2 title "paper, one thread", \
  csv using 4:(ours("cpu", 0, column(18))) with linespoints lc rgb "#999999" pt 4 dt 3 title "paper, GTX 570", \
  csv using 4:(ours("cpu", 0, column(11))) with linespoints lc rgb "#0b4f9e" pt 7 lw 1.8 title "one thread", \
  csv using 4:(ours("cpu", 1, column(11))) with linespoints lc rgb "#3fa0e0" pt 5 lw 1.8 title "all threads", \
  csv using 4:(ours("cuda", 0, column(11))) with linespoints lc rgb "#15803d" pt 9 lw 1.8 title (there("cuda") ? "GPU" : "")
