#!/usr/bin/env python3
"""Solves the same elements by fascia and by CalculiX, one thread each: time, memory, and how far the answers are apart.

usage: bench/calculix_speed.py FASCIA [CASE ...]

FASCIA is the program. Needs `ccx` (Debian: calculix-ccx) on the PATH. A cantilever of 4 m x 1 m x 1 m is clamped at x = 0, and equal
forces pull all nodes of its far end along x and z: the same nodes, elements, integration points and forces for both. Times
are those of whole processes, from reading the input to writing displacements; memory is the largest resident set. With
NLGEOM, CalculiX's linear elasticity is St Venant-Kirchhoff material; it is given a tolerance at which the answers agree. A line
of CSV for each case.
"""

import itertools
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time


from calculix import CORNERS, real, tetrahedra_of_cell

SIZE = (4.0, 1.0, 1.0)
YOUNG, POISSON = 1e6, 0.3
# Pairs of corners of an element whose middles are nodes too, in CalculiX's order.
HEXAHEDRON_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
TETRAHEDRON_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]

# Name: model, order, cells, formulation of fascia, whole force [N], element of CalculiX.
CASES = {
    "hexahedra_20_linear": ("hexahedra", 2, (40, 10, 10), "linear", (0.0, 0.0, -100.0), "C3D20"),
    "tetrahedra_10_linear": ("tetrahedra", 2, (16, 15, 7), "linear", (0.0, 0.0, -100.0), "C3D10"),
    "hexahedra_8_large": ("hexahedra", 1, (48, 16, 16), None, (20000.0, 0.0, -4000.0), "C3D8"),
}


def mesh_of(model, order, cells):
    """Places of nodes on a lattice of half cells, by number, and elements."""
    numbers, elements = {}, []

    def number(place):
        return numbers.setdefault(place, len(numbers) + 1)

    shapes = [CORNERS] if model == "hexahedra" else list(tetrahedra_of_cell())
    edges = HEXAHEDRON_EDGES if model == "hexahedra" else TETRAHEDRON_EDGES
    for k, j, i in itertools.product(*(range(n) for n in reversed(cells))):
        # Cuts of neighbouring cells mirror one another.
        odd = [n % 2 for n in (i, j, k)] if model == "tetrahedra" else [0, 0, 0]
        for shape in shapes:
            corners = [tuple(2 * (n + abs(o - c)) for n, o, c in zip((i, j, k), odd, corner)) for corner in shape]
            if sum(odd) % 2:
                corners[2], corners[3] = corners[3], corners[2]
            nodes = [number(c) for c in corners]
            if order == 2:
                nodes += [number(tuple((a + b) // 2 for a, b in zip(corners[p], corners[q]))) for p, q in edges]
            elements.append(nodes)
    places = {n: [s * a / (2 * c) for s, a, c in zip(SIZE, place, cells)] for place, n in numbers.items()}
    return places, elements


def deck(case, places, elements, force):
    formulation, element = case[3], case[5]
    near = [n for n, x in places.items() if x[0] == 0]
    far = [n for n, x in places.items() if x[0] == SIZE[0]]
    lines = ["*NODE, NSET=ALL"] + [f"{n}, " + ", ".join(map(real, x)) for n, x in places.items()]
    lines.append(f"*ELEMENT, TYPE={element}, ELSET=BODY")
    for e, nodes in enumerate(elements, 1):
        numbers = [str(e), *map(str, nodes)]
        lines += [", ".join(numbers[k : k + 15]) + ("," if k + 15 < len(numbers) else "") for k in range(0, len(numbers), 15)]
    lines += ["*MATERIAL, NAME=SOFT", "*ELASTIC", f"{real(YOUNG)}, {real(POISSON)}", "*SOLID SECTION, ELSET=BODY, MATERIAL=SOFT"]
    lines += ["*BOUNDARY"] + [f"{n}, 1, 3" for n in near]
    lines += ["*STEP" + ("" if formulation else ", NLGEOM"), "*STATIC" + ("" if formulation else "\n1., 1.")]
    if not formulation:  # by default it is content with a residual of half a percent
        lines += ["*CONTROLS, PARAMETERS=FIELD", "1e-7, 1e-7"]
    lines.append("*CLOAD")
    lines += [f"{n}, {a + 1}, {real(f)}" for n in far for a, f in enumerate(force) if f]
    lines += ["*NSET, NSET=TIPS", ", ".join(str(n) for n in far[:2]), "*NODE PRINT, NSET=TIPS", "U", "*END STEP"]
    return "\n".join(lines) + "\n", [places[n] for n in far[:2]]


def scene(case, force, tips):
    model, order, cells, formulation = case[:4]
    probes = "".join(f'[probes.tip{k}]\nbody = "beam"\nat = {list(x)}\nquantity = "displacement"\n' for k, x in enumerate(tips))
    small = f'formulation = "{formulation}"\n' if formulation else ""
    return f"""[materials.soft]
young = {YOUNG}
poisson = {POISSON}
[bodies.beam]
model = "{model}"
order = {order}
{small}domain = {{ box = {{ min = [0, 0, 0], max = {list(SIZE)}, cells = {list(cells)} }} }}
density = 1000
material = "soft"
[[constraints]]
body = "beam"
where = {{ box = {{ min = [-0.001, -1, -1], max = [0.001, 2, 2] }} }}
fix = "all"
[[loads]]
body = "beam"
where = {{ box = {{ min = [3.999, -1, -1], max = [4.001, 2, 2] }} }}
force_per_node = {list(force)}
[solver]
kind = "static"
backend = "cpu"
{probes}"""


def measured(command, folder):
    """Standard output, seconds and MB of a process."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    start = time.monotonic()
    with open(folder / "out.txt", "w") as out:
        process = subprocess.Popen(command, cwd=folder, stdout=out, stderr=subprocess.STDOUT, env=environment)
        _, _, usage = os.wait4(process.pid, 0)
    return (folder / "out.txt").read_text(), time.monotonic() - start, usage.ru_maxrss / 1000


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    names = sys.argv[2:] or list(CASES)
    print("case,unknowns,fascia_s,fascia_solve_s,fascia_mb,calculix_s,calculix_mb,times,difference")
    for name in names:
        case = CASES[name]
        places, elements = mesh_of(*case[:3])
        far = sum(x[0] == SIZE[0] for x in places.values())
        force = [f / far for f in case[4]]
        text, tips = deck(case, places, elements, force)
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            (folder / "beam.inp").write_text(text)
            (folder / "beam.toml").write_text(scene(case, force, tips))
            ours, seconds, mb = measured([program, "run", "beam.toml", "--threads", "1", "--output", "out", "--json"], folder)
            summary = json.loads(ours[ours.index("{") :]) if "{" in ours else sys.exit(ours)
            _, their_seconds, their_mb = measured(["ccx", "beam"], folder)
            rows = [line.split() for line in (folder / "beam.dat").read_text().splitlines()]
            theirs = [float(v) for r in [r for r in rows if len(r) == 4 and r[0].isdigit()][-2:] for v in r[1:]]
        u = [v for k in range(2) for v in summary["probes"][f"tip{k}"]["value"]]
        difference = max(abs(a - b) for a, b in zip(u, theirs)) / max(map(abs, u))
        print(f"{name},{summary['dofs']},{seconds:.2f},{summary['seconds']['solve']:.2f},{mb:.0f},{their_seconds:.2f},"
              f"{their_mb:.0f},{their_seconds / seconds:.1f},{difference:.1e}", flush=True)


if __name__ == "__main__":
    main()
