"""Meshes written to files of many kinds, with their surfaces as groups."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.domains.mesh import MeshDomain, MeshOptions

FLUID = 7
"""The number of the cells."""

CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
SIDES = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
TRIANGLES = np.array([corners for a, b, c, d in SIDES for corners in ((a, b, c), (a, c, d))])
"""Of a cube, turned as they come."""


def write_by_meshio(path: Path, mesh: Mesh, names: list[str]) -> None:
    """Facets numbered from 1 by their marker, cells FLUID; with names where the kind of file has them."""
    d = mesh.points.shape[1]
    kinds = ("line", "triangle", "tetra")
    points = mesh.points if d == 3 else np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    key = {".msh": "gmsh:physical", ".vtu": "part", ".mesh": "medit:ref", ".med": "cell_tags"}[path.suffix]
    sign = -1 if path.suffix == ".med" else 1
    tags = [sign * (mesh.markers + 1), np.full(len(mesh.cells), sign * FLUID)]
    data: dict[str, Any] = {key: tags}
    if path.suffix == ".msh":
        data["gmsh:geometrical"] = tags
    made = meshio.Mesh(points, [(kinds[d - 2], mesh.facets), (kinds[d - 1], mesh.cells)], cell_data=data)
    if path.suffix == ".msh":
        groups = {name: np.array([i + 1, d - 1]) for i, name in enumerate(names)}
        made.field_data = groups | {"lumen": np.array([FLUID, d])}
    if path.suffix == ".med":
        made.cell_tags = {-(i + 1): [name] for i, name in enumerate(names)} | {-FLUID: ["lumen"]}
    kind = {"file_format": "gmsh22", "binary": False} if path.suffix == ".msh" else {}
    meshio.write(path, made, **kind)


def write_gmsh41(path: Path, mesh: Mesh, names: list[str]) -> None:
    """Gmsh 4.1, as text, where numbers of groups stand with the entities and not with the cells."""
    d = mesh.points.shape[1]
    box = " ".join(["0"] * 6)
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names) + 1)]
    lines += [f'{d - 1} {i + 1} "{name}"' for i, name in enumerate(names)] + [f'{d} {FLUID} "lumen"']
    counts = {2: f"0 {len(names)} 1 0", 3: f"0 0 {len(names)} 1"}[d]
    lines += ["$EndPhysicalNames", "$Entities", counts]
    lines += [f"{10 + i} {box} 1 {i + 1} 0" for i in range(len(names))] + [f"1 {box} 1 {FLUID} 0", "$EndEntities"]
    count = len(mesh.points)
    lines += ["$Nodes", f"1 {count} 1 {count}", f"{d} 1 0 {count}", *map(str, range(1, count + 1))]
    lines += [" ".join(map(repr, [*map(float, point), *[0.0] * (3 - d)])) for point in mesh.points]
    total = len(mesh.facets) + len(mesh.cells)
    lines += ["$EndNodes", "$Elements", f"{len(names) + 1} {total} 1 {total}"]
    blocks = [(d - 1, 10 + i, d - 1, mesh.facets[mesh.markers == i]) for i in range(len(names))]
    number = 0
    for dimension, entity, kind, vertices in [*blocks, (d, 1, 2 * d - 2, mesh.cells)]:
        lines.append(f"{dimension} {entity} {kind} {len(vertices)}")
        for row in vertices + 1:
            number += 1
            lines.append(f"{number} " + " ".join(map(str, row)))
    path.write_text("\n".join([*lines, "$EndElements", ""]))


def write_stl(path: Path, points: FloatArray, facets: IntArray) -> None:
    """Triangles as text."""
    lines = ["solid surface"]
    for corners in points[facets].tolist():
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {x!r} {y!r} {z!r}" for x, y, z in corners)]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid", ""]))


def write_vol(path: Path, shape: Any, size: float) -> None:
    """What Netgen makes of a CAD shape, packed where the name ends with .gz."""
    from netgen import occ

    plain = path.with_suffix("") if path.suffix == ".gz" else path
    occ.OCCGeometry(shape).GenerateMesh(maxh=size).Save(str(plain))
    if plain != path and plain.exists():
        path.write_bytes(gzip.compress(plain.read_bytes()))


def meshed(path: Path, dimension: int = 3, **keys: Any) -> MeshDomain:
    """The domain of a file."""
    return MeshDomain(MeshOptions(file=str(path), **keys), dimension)
