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

cat >"$scene/elements.toml" <<'TEXT'
[bodies.b]
model = "tetrahedra"
order = 2
formulation = "corotational"
locking = "none"
incompressibility = 1e5
domain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = [2, 1, 1], split = 5 } }
transform = { translate = [0, 0, 1], rotate = { axis = [0, 0, 1], angle = "90 degree" }, scale = 0.001 }
density = 1000
material = [{ where = { group = "stiff" }, use = { young = 1e6, poisson = 0.49 } },
            { use = { young = 1e5, poisson = 0.3 } }]
[bodies.c]
model = "hexahedra"
domain = { cylinder = { from = [0, 0, 0], to = [0, 0, 1], radius = 0.2, cells = [2, 8] } }
mass = 1
material = { young = 1e5, poisson = 0.3, law = "neo-hookean", damping = { mass = 1, stiffness = 0.01 } }
[[constraints]]
body = "b"
where = { any_of = [{ group = 5 }, { boundary = true }] }
fix = ["x", "z"]
axes = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
[[loads]]
body = "c"
where = { all_of = [{ group = "end" }, { not = { ids = [3] } }] }
traction = [0, "1 kPa", 0]
[solver]
kind = "explicit"
time_step = "auto"
duration = "1 ms"
TEXT

cat >"$scene/couplings.toml" <<'TEXT'
[bodies.bone]
model = "rigid"
domain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = [2, 2, 2] } }
mass = 2
inertia = [["1 kg m2", 0, 0], [0, 1, 0], [0, 0, 1]]
[bodies.plate]
model = "rigid"
domain = { cylinder = { from = [0, 0, 2], to = [0, 0, 3], radius = 1, cells = [2, 8], caps = false } }
mass = 1
[bodies.skin]
model = "surface"
domain = { sphere = { center = [0, 0, 0], radius = 1, cells = [8] } }
[bodies.tissue]
model = "meshless"
domain = { between = ["bone", "plate"], where = { boundary = true }, as = "sheet" }
thickness = "2 mm"
mass = 1
material = { young = 1e5, poisson = 0.3 }
frames = { poisson_disk = 0.1, share = [{ body = "bone", where = "all", rotations = false }, { body = "plate" }] }
[couplings.ride]
kind = "embed"
body = "skin"
where = "all"
to = "tissue"
[couplings.foot]
kind = "weld"
body = "plate"
where = { nearest = [0, 0, 0] }
to = "bone"
[couplings.ligament]
kind = "spring"
body = "bone"
where = { ids = [0] }
point = [0, 0, "1 cm"]
stiffness = "2 N/mm"
direction = [0, 0, 1]
[solver]
kind = "static"
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

cat >"$gmsh/tetrahedron_1.msh" <<'TEXT'
$NOD
4
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
$ENDNOD
$ELM
2
1 2 7 1 3 1 2 3
2 4 7 1 4 1 2 3 4
$ENDELM
TEXT

cat >"$gmsh/tetrahedron.off" <<'TEXT'
OFF # a comment
4 4 6
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3 255 0 0
3 1 2 3
3 0 3 2
TEXT

cat >"$gmsh/tetrahedron.ply" <<'TEXT'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 1 2 3
3 0 3 2
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

# Quadratic cells, whose middle nodes follow the corners in Gmsh's order; a name that two dimensions share.
cat >"$gmsh/quadratic_22.msh" <<'TEXT'
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "organ"
3 7 "organ"
$EndPhysicalNames
$Nodes
10
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 0.5 0 0
6 0.5 0.5 0
7 0 0.5 0
8 0 0 0.5
9 0 0.5 0.5
10 0.5 0 0.5
$EndNodes
$Elements
2
1 9 2 7 1 1 2 3 5 6 7
2 11 2 7 1 1 2 3 4 5 6 7 8 9 10
$EndElements
TEXT

cat >"$gmsh/hexahedron_22.msh" <<'TEXT'
$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
8
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
$EndNodes
$Elements
2
1 3 2 5 1 1 4 3 2
2 5 2 1 1 1 2 3 4 5 6 7 8
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
