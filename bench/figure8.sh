#!/usr/bin/env bash
# Figure 8 of Bosman, Duriez and Cotin 2014, with finite elements beside the frames: the soft cantilever's tip against
# the converged solution, by degrees of freedom and by time.
#
#   bench/figure8.sh [FASCIA] [OUTPUT_DIR]
#
# Writes figure8.csv, figure8.md and, with gnuplot, figure8.svg and figure8.png. It takes a few minutes, on one thread.
set -euo pipefail

here=$(cd -P "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(dirname "$here")
fascia=${1:-$root/build/release/fascia}
out=${2:-$root/results/figure8}
runs=3
export OMP_THREAD_LIMIT=1 # of the direct solver too
reference=6.5096 # drop of the end face's centre [m], from converged quadratic solids

command -v "$fascia" >/dev/null 2>&1 || { echo "figure8.sh: no program at $fascia; build it or name it" >&2; exit 2; }
mkdir -p "$out"
csv=$out/figure8.csv
scene=$out/elements.toml
summary=$out/summary.json

# The beam of scenes/soft_cantilever.toml as a mesh.
cat >"$scene" <<'TOML'
title = "Soft cantilever of finite elements"

[world]
gravity = [0, -9.81, 0]

[materials.silicone]
young = "40 kPa"
poisson = 0.3

[bodies.beam]
model = "hexahedra"
domain = { box = { min = [0, -0.5, -0.5], max = [16, 0.5, 0.5], cells = [16, 1, 1] } }
mass = "5 kg"
material = "silicone"

[[constraints]]
body = "beam"
where = { box = { min = [-0.01, -1, -1], max = [0.01, 1, 1] } }
fix = "all"

[solver]
kind = "static"

[probes.tip]
body = "beam"
at = [16, 0, 0]
quantity = "displacement"
TOML

# field NAME: the number that follows a key of the last summary; the second number of a list.
field() { awk -v key="\"$1\":" '$1 == key { gsub(/[,]/, "", $2); print $2; exit }' "$summary"; }
tip() {
  awk '/"tip":/ { tip = 1 } tip && /"value":/ { getline; getline; gsub(/[, ]/, ""); print; exit }' "$summary"
}
median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

# measure SERIES LABEL SCENE SETTING...: one row of the table.
measure() {
  local series=$1 label=$2 file=$3 settings=() times=() setting time
  for setting in solver.linear.kind=cholesky "${@:4}"; do settings+=(--set "$setting"); done
  for _ in $(seq $runs); do
    "$fascia" run "$file" --json --quiet --threads 1 --output "$out/run" "${settings[@]}" >"$summary"
    times+=("$(field solve)")
  done
  time=$(printf '%s\n' "${times[@]}" | median)
  awk -v s="$series" -v l="$label" -v d="$(field dofs)" -v n="$(field newton_iterations)" -v y="$(tip)" -v t="$time" \
    -v r=$reference 'BEGIN { printf "%s,%s,%d,%d,%.5f,%.3f,%.2f\n", s, l, d, n, -y, 100 * (-y / r - 1), 1000 * t }' |
    tee -a "$csv"
}
frames() { # SERIES SCENE GRID...
  local series=$1 file=$root/scenes/$2.toml grid
  for grid in "${@:3}"; do measure "$series" "${grid//,/x}" "$file" "bodies.beam.frames.grid=[$grid]"; done
}
elements() { # SERIES MODEL ORDER CELLS...
  local series=$1 model=$2 order=$3 cells
  for cells in "${@:4}"; do
    measure "$series" "${cells//,/x}" "$scene" "bodies.beam.model=$model" "bodies.beam.order=$order" \
      "bodies.beam.domain.box.cells=[$cells]"
  done
}

echo "discretisation,size,dofs,newton_iterations,drop_m,error_percent,solve_ms" | tee "$csv"
frames "rigid frames" soft_cantilever 9,2,2 9,3,3 21,3,3 33,4,4 65,5,5
frames "affine frames" affine_cantilever 5,2,2 9,2,2 9,3,3 21,3,3 33,4,4 65,5,5
elements "linear tetrahedra" tetrahedra 1 20,2,2 32,4,4 64,4,4 64,8,8 128,8,8
elements "quadratic tetrahedra" tetrahedra 2 4,1,1 8,1,1 16,1,1 16,2,2 32,2,2 32,4,4
elements "linear hexahedra" hexahedra 1 20,2,2 32,4,4 64,4,4 64,8,8 128,8,8
elements "quadratic hexahedra" hexahedra 2 4,1,1 8,1,1 16,1,1 16,2,2 32,2,2 32,4,4
rm -r "$out/run" "$scene" "$summary"

{
  echo "| discretisation | frames or cells | DOFs | Newton iterations | drop [m] | error [%] | solve [ms] |"
  echo "|---|---|---|---|---|---|---|"
  awk -F, 'NR > 1 { printf "| %s | %s | %s | %s | %.4f | %+.2f | ", $1, $2, $3, $4, $5, $6
                    printf "%.*f |\n", $7 < 100 ? 1 : 0, $7 }' "$csv"
} >"$out/figure8.md"

if command -v gnuplot >/dev/null 2>&1; then
  for format in svg png; do
    gnuplot -e "csv='$csv'; format='$format'; picture='$out/figure8.$format'" "$here/figure8.gp"
  done
  echo "$out: figure8.csv, figure8.md, figure8.svg, figure8.png"
else
  echo "$out: figure8.csv, figure8.md; for the pictures install gnuplot (Debian: apt-get install gnuplot-nox)"
fi
