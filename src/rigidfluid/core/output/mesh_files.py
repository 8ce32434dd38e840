"""A mesh for other programs, with the names of its surfaces: VTU for ParaView, MSH for Gmsh."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.output.disk import replace_file
from rigidfluid.core.output.vtu import data_array, in_space

FLUID = "fluid"
"""The name of the cells."""

_VTK = {2: 3, 3: 5, 4: 10}
_GMSH = {2: 1, 3: 2, 4: 4}
"""Numbers of the straight edge, triangle and tetrahedron by how many vertices they have."""


def write_mesh_vtu(path: Path, mesh: Mesh, names: Sequence[str]) -> None:
    """Write cells and boundary facets; ``surface`` is the number of a facet's surface, -1 of cells; next to them the
    name of each surface has its number."""
    blocks = [mesh.cells, mesh.facets]
    root = ET.Element(
        "VTKFile", type="UnstructuredGrid", version="1.0", byte_order="LittleEndian", header_type="UInt64"
    )
    grid = ET.SubElement(root, "UnstructuredGrid")
    numbers = ET.SubElement(grid, "FieldData")
    for number, name in enumerate(names):
        data_array(numbers, name, np.array([number], dtype="<i8"))
        numbers[-1].set("NumberOfTuples", "1")
    count = sum(map(len, blocks))
    piece = ET.SubElement(grid, "Piece", NumberOfPoints=str(len(mesh.points)), NumberOfCells=str(count))
    data_array(ET.SubElement(piece, "Points"), "points", in_space(mesh.points).astype("<f8"))
    topology = ET.SubElement(piece, "Cells")
    widths = np.concatenate([np.full(len(block), block.shape[1]) for block in blocks])
    data_array(topology, "connectivity", np.concatenate([block.ravel() for block in blocks]).astype("<i8"))
    data_array(topology, "offsets", np.cumsum(widths).astype("<i8"))
    data_array(topology, "types", np.array([_VTK[width] for width in widths.tolist()], dtype="u1"))
    surface = np.concatenate([np.full(len(mesh.cells), -1), mesh.markers])
    data_array(ET.SubElement(piece, "CellData", Scalars="surface"), "surface", surface.astype("<i8"))
    ET.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def write_msh(path: Path, mesh: Mesh, names: Sequence[str]) -> None:
    """Write Gmsh's format 2.2 in ASCII: a physical group for each surface, and one, FLUID, for the cells.

    Group i + 1 is surface i, the last one the fluid. Coordinates are written to the last bit.
    """
    d, groups = mesh.points.shape[1], [*names, FLUID]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups))]
    for number, name in enumerate(groups, start=1):
        lines.append(f'{d - (number <= len(names))} {number} "{name}"')
    lines += ["$EndPhysicalNames", "$Nodes", str(len(mesh.points))]
    for number, (x, y, z) in enumerate(in_space(mesh.points).tolist(), start=1):
        lines.append(f"{number} {x!r} {y!r} {z!r}")
    lines += ["$EndNodes", "$Elements", str(len(mesh.facets) + len(mesh.cells))]
    lines += _elements(mesh.facets, mesh.markers + 1, 1)
    lines += _elements(mesh.cells, np.full(len(mesh.cells), len(groups)), len(mesh.facets) + 1)
    replace_file(path, "\n".join([*lines, "$EndElements", ""]).encode())


def _elements(simplices: IntArray, groups: IntArray, first: int) -> list[str]:
    """Lines of Gmsh's elements: number, kind, two tags, which are the group, and vertices, all from 1."""
    kind, group = _GMSH[simplices.shape[1]], groups.tolist()
    return [
        f"{first + k} {kind} 2 {group[k]} {group[k]} {' '.join(map(str, vertices))}"
        for k, vertices in enumerate((simplices + 1).tolist())
    ]
