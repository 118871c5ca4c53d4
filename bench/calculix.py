#!/usr/bin/env python3
"""Gives static cells of the map of extremes to CalculiX, and tells both answers.

usage: bench/calculix.py FASCIA MAP [MODEL ...]

FASCIA is the program, MAP a directory that `fascia extremes` has written. Needs `ccx` (Debian: calculix-ccx) on the PATH.
Cells of hexahedra (C3D8) and of tetrahedra (C3D4) are taken whose mesh is a box and whose law is St Venant-Kirchhoff: the same nodes, elements, supports and
nodal forces. With NLGEOM, CalculiX's linear elasticity relates Green-Lagrange strain and the second Piola-Kirchhoff stress:
St Venant-Kirchhoff material, as in these cells. A line for each cell: how both ended, and the largest difference of the
displacements at the far end and near the middle, relative to the largest of them.
"""

import itertools
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

# Probes of the cells that stand on nodes.
PROBES = ["tip", "middle"]

# Corners of a cell in the order of C3D8, and the six tetrahedra around its diagonal: the paths along edges from corner
# 0 to corner 6.
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def real(value):
    """CalculiX takes fields of at most 20 characters."""
    return f"{float(value):.11e}"


def tetrahedra_of_cell():
    for order in itertools.permutations(range(3)):
        corner = [0, 0, 0]
        path = [tuple(corner)]
        for axis in order:
            corner[axis] = 1
            path.append(tuple(corner))
        odd = order in [(0, 2, 1), (1, 0, 2), (2, 1, 0)]
        yield [path[0], path[2], path[1], path[3]] if odd else path


def mesh_of(box, model):
    """Nodes by number, elements, and each element's first cell index along x."""
    low, high, cells = box["min"], box["max"], box["cells"]

    def number(i, j, k):
        return 1 + i + (cells[0] + 1) * (j + (cells[1] + 1) * k)

    nodes = {}
    for k, j, i in itertools.product(*(range(n + 1) for n in reversed(cells))):
        nodes[number(i, j, k)] = [l + (h - l) * a / n for l, h, a, n in zip(low, high, (i, j, k), cells)]
    shapes = [CORNERS] if model == "hexahedra" else list(tetrahedra_of_cell())
    elements = []
    for k, j, i in itertools.product(*(range(n) for n in reversed(cells))):
        # Cuts of neighbouring cells mirror one another.
        odd = [n % 2 for n in (i, j, k)] if model == "tetrahedra" else [0, 0, 0]
        for shape in shapes:
            corners = [number(*(n + abs(o - c) for n, o, c in zip((i, j, k), odd, corner))) for corner in shape]
            if sum(odd) % 2:
                corners[2], corners[3] = corners[3], corners[2]
            elements.append((i, corners))
    return nodes, elements


def deck(scene):
    """The input of CalculiX; none where a load or a motion is none that it is given here."""
    body = scene["bodies"]["beam"]
    box = body["domain"]["box"]
    nodes, elements = mesh_of(box, body["model"])
    length = box["max"][0]
    near = [n for n, x in nodes.items() if x[0] == 0]
    far = [n for n, x in nodes.items() if abs(x[0] - length) <= 1e-9 * length]

    def nearest(to):
        return min(nodes, key=lambda n: sum((a - b) ** 2 for a, b in zip(nodes[n], to)))

    looked_at = [nearest(scene["probes"][name]["at"]) for name in PROBES]
    lines = ["*NODE, NSET=ALL"] + [f"{n}, " + ", ".join(map(real, x)) for n, x in nodes.items()]
    kind = "C3D8" if body["model"] == "hexahedra" else "C3D4"
    halves = {"NEARHALF": [], "FARHALF": []}
    for e, (i, corners) in enumerate(elements, 1):
        halves["NEARHALF" if i < box["cells"][0] // 2 else "FARHALF"].append((e, corners))
    for name, members in halves.items():
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        lines += [f"{e}, " + ", ".join(map(str, corners)) for e, corners in members]
    for name, material in (("NEARHALF", "near"), ("FARHALF", "far")):
        values = scene["materials"].get(material, scene["materials"]["near"])
        lines += [f"*MATERIAL, NAME={material}", "*ELASTIC", f"{real(values['young'])}, {real(values['poisson'])}",
                  f"*SOLID SECTION, ELSET={name}, MATERIAL={material}"]
    lines += ["*BOUNDARY"] + [f"{n}, 1, 3" for n in near]
    lines += ["*STEP, NLGEOM, INC=500", "*STATIC", "0.1, 1., 1e-9, 1."]
    # A total force is shared by the area of faces, which are all of one size.
    shares = {n: 0 for n in far}
    for _, corners in elements:
        face = [n for n in corners if n in shares]
        if len(face) == (4 if kind == "C3D8" else 3):
            for n in face:
                shares[n] += 1
    for constraint in scene["constraints"]:
        if "move" in constraint:
            if "translate" not in constraint["move"]:
                return None
            lines.append("*BOUNDARY")
            lines += [f"{n}, {a + 1}, {a + 1}, {real(u)}" for n in far for a, u in enumerate(constraint["move"]["translate"])]
    for load in scene.get("loads", []):
        if "total_force" not in load:
            return None
        lines.append("*CLOAD")
        for n, share in shares.items():
            for a, f in enumerate(load["total_force"]):
                lines.append(f"{n}, {a + 1}, {real(f * share / sum(shares.values()))}")
    for name, node in zip(PROBES, looked_at):
        lines += [f"*NSET, NSET={name}", str(node), f"*NODE PRINT, NSET={name}", "U"]
    lines.append("*END STEP")
    return "\n".join(lines) + "\n"


def calculix(text, folder):
    (folder / "cell.inp").write_text(text)
    try:
        run = subprocess.run(["ccx", "cell"], cwd=folder, capture_output=True, text=True, timeout=120)
    except subprocess.TimeoutExpired:
        return "time limit", None
    rows = [line.split() for line in (folder / "cell.dat").read_text().splitlines()] if (folder / "cell.dat").exists() else []
    rows = [r for r in rows if len(r) == 4 and r[0].isdigit()]
    if "best solution and residuals" in run.stdout or "*ERROR" in run.stdout + run.stderr or run.returncode != 0:
        reason = [line.strip() for line in (run.stdout + run.stderr).splitlines() if "ERROR" in line]
        return "stopped" + (": " + reason[0] if reason else ""), None
    return "converged", [float(v) for row in rows[-len(PROBES) :] for v in row[1:]] if rows else None


def main():
    program, directory = sys.argv[1], pathlib.Path(sys.argv[2])
    models = sys.argv[3:] or ["hexahedra", "tetrahedra"]
    print("cell,fascia,calculix,difference")
    for model in models:
        for file in sorted((directory / "cells").glob(f"{model}-static-cholesky-*.toml")):
            scene = tomllib.loads(file.read_text())
            if "box" not in scene["bodies"]["beam"]["domain"] or "world" in scene or "constraints" not in scene:
                continue
            if any("law" in m for m in scene["materials"].values()):
                continue
            text = deck(scene)
            if text is None:
                continue
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                command = [program, "run", str(file), "--json", "--threads", "1", "--output", str(folder / "out")]
                if model == "tetrahedra":  # CalculiX has no remedy against their locking
                    command += ["--set", 'bodies.beam.locking="none"']
                ours = subprocess.run(command, capture_output=True, text=True)
                summary = json.loads(ours.stdout) if ours.stdout.startswith("{") else {"status": "refused"}
                status, theirs = calculix(text, folder)
            difference = ""
            if summary["status"] == "converged" and theirs:
                u = [v for name in PROBES for v in summary["probes"][name]["value"]]
                size = max(abs(v) for v in u)
                difference = f"{max(abs(a - b) for a, b in zip(u, theirs)) / size:.1e}"
            print(f"{file.stem},{summary['status']},{status},{difference}", flush=True)


if __name__ == "__main__":
    main()
