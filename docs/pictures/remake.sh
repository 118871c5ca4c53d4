#!/usr/bin/env bash
# Remakes the pictures in this folder from the scenes: remake.sh [NAME...]; all without a name, which takes some minutes.
set -euo pipefail
here=$(cd -P "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(dirname "$(dirname "$here")")
fascia=${FASCIA:-$root/build/release/fascia}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Sizes and views that are not the scene's own.
declare -A settings=(
  [cook_neo_hookean]='output.picture={view=[0.3,0.2,1],size=[800,533]}'
  [liver_like]='output.picture.size=[800,533]'
  [liver_tetrahedra]='output.picture.size=[800,533]'
  [pushed_cylinder]='output.picture={view=[0.4,-1,0.5],size=[800,533]}'
  [soft_cantilever]='output.picture={view=[0.5,0.3,1],size=[1000,667]}'
)

if [ $# -eq 0 ]; then
  for picture in "$here"/*.png; do set -- "$@" "$(basename "$picture" .png)"; done
fi
for name in "$@"; do
  if [ "$name" = frames ]; then  # of the soft cantilever
    "$fascia" run "$root/scenes/soft_cantilever.toml" --quiet --output "$work/frames"
    xvfb-run -a "$(dirname "$fascia")/fascia-picture" "$work/frames/beam_00000.vtu" "$here/frames.png" --frames \
      --view 0.5,0.3,1 --size 1000x667
    echo frames.png
    continue
  fi
  options=()
  [ -z "${settings[$name]:-}" ] || options=(--set "${settings[$name]}")
  "$fascia" run "$root/scenes/$name.toml" --quiet --output "$work/$name" "${options[@]}"
  cp "$work/$name/$name.png" "$here/$name.png"
  rm -r "${work:?}/$name"
  echo "$name.png"
done
