#!/usr/bin/env bash
# Table 3 of Bosman, Duriez and Cotin 2014 on this machine: fascia bench table3, and a plot of it.
#
#   bench/table3.sh [FASCIA] [OUTPUT_DIR] [options of fascia bench]
#
# Writes table3.txt, table3.csv, table3.json, the scenes and, with gnuplot, table3.svg and table3.png.
set -euo pipefail

here=$(cd -P "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(dirname "$here")
fascia=${1:-$root/build/release/fascia}
out=${2:-$root/results/table3}

command -v "$fascia" >/dev/null 2>&1 || { echo "table3.sh: no program at $fascia; build it or name it" >&2; exit 2; }
"$fascia" bench table3 --output "$out" "${@:3}"
if command -v gnuplot >/dev/null 2>&1; then
  for format in svg png; do
    gnuplot -e "csv='$out/table3.csv'; format='$format'; setting='paper'; picture='$out/table3.$format'" "$here/table3.gp"
  done
else
  echo "for the pictures install gnuplot (Debian: apt-get install gnuplot-nox)"
fi
