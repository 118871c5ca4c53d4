#!/usr/bin/env bash
# Writes the inputs from which the fuzz targets start into DIRECTORY/scene and DIRECTORY/gmsh: fuzz_seeds.sh DIRECTORY
set -euo pipefail
root=$(cd -P "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
scene=$1/scene gmsh=$1/gmsh
mkdir -p "$scene" "$gmsh"

find "$root/scenes" "$root/tests" -name '*.toml' -size -64k -exec cp {} "$scene" \;
find "$root/scenes" "$root/tests" -name '*.msh' -size -64k -exec cp {} "$gmsh" \;

cat >"$scene/smallest.toml" <<'TEXT'
[world]
gravity = [0, "-9.81 m/s2", 0]
[bodies.b]
model = "meshless"
domain = { box = { min = [0, 0, 0], max = ["10 cm", 1, 1] } }
mass = "5 kg"
material = { young = "40 kPa", poisson = 0.3 }
frames = { grid = [3, 3, 3] }
[[constraints]]
body = "b"
where = { any_of = [{ halfspace = { point = [0, 0, 0], normal = [1, 0, 0] } }, { not = { ids = [0, 5] } }] }
move = { rotate = { axis = [0, 0, 1], angle = "720 degree", center = [0, 0, 0] } }
over = "1 s"
profile = [[0, 0], [1, 1]]
[solver]
kind = "implicit-euler"
time_step = "10 ms"
steps = 10
TEXT

cat >"$gmsh/tetrahedron_22.msh" <<'TEXT'
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
3 7 "organ"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
$EndNodes
$Elements
2
1 2 2 7 1 1 2 3
2 4 2 7 1 1 2 3 4
$EndElements
TEXT

cat >"$gmsh/tetrahedron_41.msh" <<'TEXT'
$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
1
3 7 "organ"
$EndPhysicalNames
$Entities
0 0 0 1
1 0 0 0 1 1 1 1 7 0
$EndEntities
$Nodes
1 4 1 4
3 1 0 4
1
2
3
4
0 0 0
1 0 0
0 1 0
0 0 1
$EndNodes
$Elements
1 1 1 1
3 1 4 1
1 1 2 3 4
$EndElements
TEXT

# Little-endian binary counterparts: a 4-byte integer, a size of 8 bytes, the numbers 0 and 1 as doubles.
int() { local i; for i in "$@"; do printf "\\x$(printf %02x "$i")\\0\\0\\0"; done; }
size() { local i; for i in "$@"; do printf "\\x$(printf %02x "$i")\\0\\0\\0\\0\\0\\0\\0"; done; }
zero() { printf '\0\0\0\0\0\0\0\0'; }
one() { printf '\0\0\0\0\0\0\xf0\x3f'; }
corners() { zero; zero; zero; one; zero; zero; zero; one; zero; zero; zero; one; }
{
  printf '$MeshFormat\n2.2 1 8\n'; int 1
  printf '\n$EndMeshFormat\n$Nodes\n4\n'
  int 1; zero; zero; zero; int 2; one; zero; zero; int 3; zero; one; zero; int 4; zero; zero; one
  printf '\n$EndNodes\n$Elements\n1\n'; int 4 1 2 1 7 1 1 2 3 4
  printf '\n$EndElements\n'
} >"$gmsh/tetrahedron_22_binary.msh"
{
  printf '$MeshFormat\n4.1 1 8\n'; int 1
  printf '\n$EndMeshFormat\n$Nodes\n'; size 1 4 1 4; int 3 1 0; size 4 1 2 3 4; corners
  printf '\n$EndNodes\n$Elements\n'; size 1 1 1 1; int 3 1 4; size 1 1 1 2 3 4
  printf '\n$EndElements\n'
} >"$gmsh/tetrahedron_41_binary.msh"
