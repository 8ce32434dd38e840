"""Whole files of every kind that a scene reads a shape or a table from, and the scenes that read them."""

from __future__ import annotations

import contextlib
import gzip
import io
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from netgen import meshing, occ

RADIUS, HEIGHT = 1.0, 4.0
"""Sizes of a cylinder about the z axis, or in 2D of a disk."""

_CELLS = {2: ("line", "triangle"), 3: ("triangle", "tetra")}
_MESHIO: dict[str, dict[str, Any]] = {
    "text22.msh": {"file_format": "gmsh22", "binary": False},
    "binary22.msh": {"file_format": "gmsh22", "binary": True},
    "text.vtu": {"binary": False},
    "binary.vtu": {"binary": True, "compression": None},
    "packed.vtu": {"binary": True, "compression": "zlib"},
    "text.mesh": {},
    "binary.meshb": {},
    "cells.med": {},
}
"""Files that meshio writes, and how."""


def write_files(folder: Path) -> dict[Path, dict[str, Any]]:
    """Write a file of each kind; the tables of the scene that reads it, by its path."""
    folder.mkdir(parents=True, exist_ok=True)
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        scenes = {path: _domain_scene(path, "cad", dimension) for path, dimension in _write_drawings(folder).items()}
        scenes |= {path: _domain_scene(path, "mesh", dimension) for path, dimension in _write_meshes(folder).items()}
    scenes[folder / "domain.stl"] = _domain_scene(folder / "domain.stl", "mesh", 3)
    for name in ("text_body.stl", "body.stl"):
        scenes[folder / name] = _body_scene(folder / name)
    scenes[folder / "table.csv"] = _table_scene(folder / "table.csv")
    return scenes


def _write_drawings(folder: Path) -> dict[Path, int]:
    solid, face = _solid(), _face()
    solid.WriteStep(str(folder / "solid.step"))
    solid.WriteBrep(str(folder / "solid.brep"))
    face.WriteBrep(str(folder / "face.brep"))
    return {folder / "solid.step": 3, folder / "solid.brep": 3, folder / "face.brep": 2}


def _write_meshes(folder: Path) -> dict[Path, int]:
    found: dict[Path, int] = {}
    for shape, dimension in ((_face(), 2), (_solid(), 3)):
        mesh = occ.OCCGeometry(shape, dim=dimension).GenerateMesh(maxh=0.8)
        path = folder / f"netgen{dimension}.vol"
        mesh.Save(str(path))
        packed = path.with_suffix(".vol.gz")
        packed.write_bytes(gzip.compress(path.read_bytes(), mtime=0))
        found |= {path: dimension, packed: dimension}
        made = _in_meshio(mesh, dimension)
        for name, how in _MESHIO.items():
            path = folder / f"{dimension}_{name}"
            meshio.write(path, _for_format(path.suffix, made), **how)
            found[path] = dimension
        found[_write_gmsh41(folder / f"{dimension}_text41.msh", made, dimension)] = dimension
        if dimension == 3:
            _write_stl(folder, made)
    return found


def _in_meshio(mesh: meshing.Mesh, dimension: int) -> meshio.Mesh:
    points = np.array(mesh.Coordinates())
    points = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])
    outer, inner = (mesh.Elements1D(), mesh.Elements2D()) if dimension == 2 else (mesh.Elements2D(), mesh.Elements3D())
    cells = [
        (kind, np.array([[vertex.nr - 1 for vertex in cell.vertices][: size + dimension] for cell in container]))
        for kind, container, size in zip(_CELLS[dimension], (outer, inner), (0, 1), strict=True)
    ]
    return meshio.Mesh(points, cells)


def _for_format(suffix: str, mesh: meshio.Mesh) -> meshio.Mesh:
    """A mesh with the numbers of its cells as files of this kind have them."""
    tags = [np.full(len(block.data), number) for number, block in enumerate(mesh.cells, start=1)]
    if suffix == ".med":
        return meshio.Mesh(mesh.points, mesh.cells, cell_data={"cell_tags": [-block for block in tags]})
    if suffix == ".msh":
        data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
        return meshio.Mesh(mesh.points, mesh.cells, cell_data=data)
    return meshio.Mesh(mesh.points, mesh.cells, cell_data={"medit:ref": tags})


def _write_gmsh41(path: Path, mesh: meshio.Mesh, dimension: int) -> Path:
    """Gmsh 4.1 as text, where numbers of groups stand with entities: here one of all facets, and one of all cells."""
    entity, count = " ".join(["1", *["0"] * 6, "1"]), len(mesh.points)
    counts = {2: "0 1 1 0", 3: "0 0 1 1"}[dimension]
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Entities", counts, f"{entity} 1 0", f"{entity} 2 0"]
    lines += ["$EndEntities", "$Nodes", f"1 {count} 1 {count}", f"{dimension} 1 0 {count}"]
    lines += [*map(str, range(1, count + 1)), *(" ".join(map(str, point)) for point in mesh.points.tolist())]
    total = sum(len(block.data) for block in mesh.cells)
    lines += ["$EndNodes", "$Elements", f"2 {total} 1 {total}"]
    for block, kind in zip(mesh.cells, (dimension - 1, {2: 2, 3: 4}[dimension]), strict=True):
        lines.append(f"{block.dim} 1 {kind} {len(block.data)}")
        lines += [f"{i} {' '.join(map(str, (cell + 1).tolist()))}" for i, cell in enumerate(block.data, start=1)]
    path.write_text("\n".join([*lines, "$EndElements", ""]), encoding="ascii")
    return path


def _write_stl(folder: Path, mesh: meshio.Mesh) -> None:
    surface = meshio.Mesh(mesh.points, [("triangle", mesh.cells[0].data)])
    for name, binary in (("domain.stl", True), ("body.stl", True), ("text_body.stl", False)):
        meshio.write(folder / name, surface, binary=binary)


def _solid() -> Any:
    return occ.Cylinder(occ.Pnt(0, 0, 0), occ.Z, RADIUS, HEIGHT)


def _face() -> Any:
    return occ.Circle(occ.Pnt(0, 0), RADIUS).Face()


def _domain_scene(path: Path, kind: str, dimension: int) -> dict[str, Any]:
    sides = 3 if dimension == 3 and path.name.startswith(("solid", "netgen")) else 1
    sign = -1 if path.suffix == ".med" else 1
    domain = {"type": kind, "file": str(path), "faces": {"wall": [sign * side for side in range(1, sides + 1)]}}
    centre = [0.0, 0.0, 0.5 * HEIGHT][:dimension]
    return _scene(domain, {"type": "sphere", "radius": 0.1, "density": 1.0, "position": centre}, dimension)


def _body_scene(path: Path) -> dict[str, Any]:
    domain = {"type": "box", "lower": [-9.0] * 3, "upper": [9.0] * 3}
    return _scene(domain, {"type": "stl", "file": str(path), "density": 1.0, "position": [0.0] * 3}, 3)


def _table_scene(path: Path) -> dict[str, Any]:
    path.write_text("".join(f"{0.01 * n}, {0.1 * n}\n" for n in range(20)), encoding="ascii")
    domain = {"type": "box", "lower": [-9.0] * 2, "upper": [9.0] * 2}
    inflow = {"type": "velocity", "on": "left", "velocity": [1.0, 0.0], "over_time": {"file": str(path)}}
    outflow = {"type": "pressure", "on": "right", "pressure": 0.0}
    wet = {"fluid": {"density": 1.0, "viscosity": 1.0}, "mesh": {"size": 3.0, "size_body": 0.05}}
    body = {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.0, 0.0]}
    return _scene(domain, body, 2) | wet | {"boundary": [inflow, outflow]}


def _scene(domain: dict[str, Any], body: dict[str, Any], dimension: int) -> dict[str, Any]:
    return {
        "scene": {"name": "damaged", "dimension": dimension},
        "fluid": {"backend": "dry"},
        "domain": domain,
        "body": [body],
        "time": {"end": 0.1, "step": 0.05},
        "output": {"every": 0.1},
    }
