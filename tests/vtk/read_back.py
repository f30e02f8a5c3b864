"""Reads what `output.formats = ["vtk"]` writes with VTK itself and compares it with the tables beside it: every point, every value, every time.

    python3 tests/vtk/read_back.py OPENCLOSE        (needs python3-vtk9; make verify-vtk installs it)
"""

import csv
import json
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
from pathlib import Path

import vtk

SCENE = """
title = "Two blocks that slide and fall"
[[material]]
name = "rock"
density_kg_per_m3 = 2500
[[joint]]
materials = ["rock", "rock"]
normal_stiffness_pa_per_m = 1e9
shear_stiffness_pa_per_m = 4e8
friction_angle_deg = 25
[[block]]
name = "base"
material = "rock"
fixed = true
vertices_m = [[-2, -3], [9, -3], [9, -2], [-2, 1.5]]
[[block]]
name = "lower"
material = "rock"
vertices_m = [[0, 0.8636363636363636], [2, 0.22727272727272727], [2.3, 1.2], [0.3, 1.8]]
[[block]]
name = "thrown"
material = "rock"
vertices_m = [[3, 3], [4, 3], [3.4, 3.5], [3.2, 4]]
velocity_m_per_s = [1, 2]
angular_velocity_rad_per_s = 3
[method]
start = "unloaded"
[step]
dt_s = 1e-3
[end]
time_s = 0.4
[output]
snapshots_every_s = 0.1
formats = ["vtk"]
"""


def rows_of(path: Path, state: str) -> list[dict[str, str]]:
    with open(path, newline="", encoding="utf-8") as stream:
        return [row for row in csv.DictReader(stream) if row["state"] == state]


def require(holds: bool, what: str) -> None:
    if not holds:
        sys.exit(f"read_back: {what}")


def grid_in(path: Path) -> vtk.vtkUnstructuredGrid:
    reader = vtk.vtkXMLUnstructuredGridReader()
    errors: list[str] = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(path.name))
    require(bool(reader.CanReadFile(str(path))), f"VTK cannot read {path.name}")
    reader.SetFileName(str(path))
    reader.Update()
    require(not errors, f"VTK reports errors in {path.name}")
    return reader.GetOutput()


def compare_blocks(grid: vtk.vtkUnstructuredGrid, folder: Path, state: str) -> None:
    outlines, motions = rows_of(folder / "blocks.csv", state), rows_of(folder / "block_states.csv", state)
    require(grid.GetNumberOfPoints() == len(outlines), f"{state}: {grid.GetNumberOfPoints()} points for {len(outlines)} vertices")
    for i, row in enumerate(outlines):
        require(grid.GetPoint(i) == (float(row["x_m"]), float(row["y_m"]), 0.0), f"{state}: point {i} is elsewhere")
    require(grid.GetNumberOfCells() == len(motions), f"{state}: {grid.GetNumberOfCells()} cells for {len(motions)} blocks")
    data = grid.GetCellData()
    for i, row in enumerate(motions):
        require(grid.GetCellType(i) == vtk.VTK_POLYGON, f"{state}: cell {i} is no polygon")
        vertices = sum(other["block"] == row["block"] for other in outlines)
        require(grid.GetCell(i).GetNumberOfPoints() == vertices, f"{state}: {row['block']} has other vertices")
        for name, columns in (("displacement_m", ("displacement_x_m", "displacement_y_m")), ("velocity_m_per_s", ("velocity_x_m_per_s", "velocity_y_m_per_s"))):
            require(data.GetArray(name).GetTuple3(i)[:2] == tuple(float(row[c]) for c in columns), f"{state}: {name} of {row['block']}")
        for name in ("rotation_rad", "angular_velocity_rad_per_s"):
            require(data.GetArray(name).GetTuple1(i) == float(row[name]), f"{state}: {name} of {row['block']}")


def compare_contacts(grid: vtk.vtkUnstructuredGrid, folder: Path, state: str) -> int:
    rows = rows_of(folder / "contacts.csv", state)
    require(grid.GetNumberOfCells() == len(rows), f"{state}: {grid.GetNumberOfCells()} cells for {len(rows)} contacts")
    data = grid.GetPointData()
    for i, row in enumerate(rows):
        require(grid.GetPoint(i) == (float(row["x_m"]), float(row["y_m"]), 0.0), f"{state}: contact {i} is elsewhere")
        for name in ("normal_force_n", "shear_force_n", "gap_m", "length_m"):
            require(data.GetArray(name).GetTuple1(i) == float(row[name]), f"{state}: {name} of contact {i}")
        require(int(data.GetArray("status").GetTuple1(i)) == ("open", "sticking", "sliding").index(row["status"]), f"{state}: status of contact {i}")
    return len(rows)


def main() -> None:
    openclose = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
        subprocess.run([openclose, "run", "scene.toml", "-o", "out", "-q"], cwd=folder, check=True)
        out = folder / "out"
        states = ["start", "t=0.1", "t=0.2", "t=0.3", "t=0.4"]  # "final" is t=0.4 once more
        contacts = 0
        for kind in ("blocks", "contacts"):
            series = xml.etree.ElementTree.parse(out / "vtk" / f"{kind}.pvd").getroot().findall("./Collection/DataSet")
            require(len(series) == len(states), f"{kind}.pvd has {len(series)} states")
            for entry, state in zip(series, states):
                time = float(rows_of(out / "block_states.csv", state)[0]["time_s"])
                require(float(entry.get("timestep")) == time, f"{kind}.pvd: the time of {state}")
                require(entry.get("file").endswith(f"_{state}.vtu"), f"{kind}.pvd: {entry.get('file')} is to be {state}")
                grid = grid_in(out / "vtk" / entry.get("file"))
                if kind == "blocks":
                    compare_blocks(grid, out, state)
                else:
                    contacts += compare_contacts(grid, out, state)
        require(contacts > 0, "no contact was compared")
        require(json.loads((out / "summary.json").read_text())["converged"], "the run did not converge")
    print(f"VTK {vtk.vtkVersion().GetVTKVersion()} reads {len(states)} states of blocks and {contacts} contacts as the tables have them")


if __name__ == "__main__":
    main()
