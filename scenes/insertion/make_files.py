"""Makes the files that scenes/insertion_2d.toml and insertion_3d.toml name: python scenes/insertion/make_files.py"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from netgen import meshing, occ

from rigidfluid.core.mesh.generation.meshing import EdgeLengths, elements, netgen_mesh
from rigidfluid.core.mesh.topology import orient
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.output.mesh_files import write_msh

FOLDER = Path(__file__).parent
NAMES = ("wall", "island", "inlet", "upper_outlet", "lower_outlet")


def vessel() -> Any:
    """A vessel with an aneurysm, a waist and an island in it, that parts into two."""
    shape = occ.WorkPlane().MoveTo(0, -2).Rectangle(12, 4).Face()
    shape += occ.WorkPlane().Circle(4.5, 1.8, 2.4).Face()
    for turn in (32.0, -28.0):
        branch = occ.WorkPlane().MoveTo(0, -1.4).Rectangle(11, 2.8).Face()
        shape += branch.Rotate(occ.Axis((0, 0, 0), occ.Z), turn).Move(occ.Vec(10.5, 0.35 if turn > 0 else -0.35, 0))
    shape -= occ.WorkPlane().Circle(2.2, -3.3, 2.0).Face()
    island = occ.WorkPlane(occ.Axes((8.4, -0.1, 0), n=occ.Z, h=occ.Dir(1, 0.3, 0))).Ellipse(1.3, 0.45).Face()
    for edge in shape.edges:
        edge.name = _name(edge.center)
    for edge in island.edges:
        edge.name = "island"
    return shape - island


def _name(middle: Any) -> str:
    if middle.x < 1e-6:
        return "inlet"
    if middle.x < 18.0:
        return "wall"
    if abs(np.hypot(middle.x - 10.5, middle.y - 0.35) - 11.0) < 1e-6:
        return "upper_outlet"
    return "lower_outlet" if abs(np.hypot(middle.x - 10.5, middle.y + 0.35) - 11.0) < 1e-6 else "wall"


def write_vessel() -> None:
    """A coarse mesh of it, as a segmentation would give one."""
    netgen = netgen_mesh(vessel(), 2, EdgeLengths(0.5, 0.3))
    facets, regions = elements(netgen.Elements1D(), 2)
    cells, _ = elements(netgen.Elements2D(), 3)
    names = [netgen.GetBCName(region) for region in range(regions.max() + 1)]
    markers = np.array([NAMES.index(name) for name in names])[regions]
    points = np.round(netgen.Coordinates()[:, :2], 6)
    write_msh(FOLDER / "vessel.msh", orient(Mesh(points, cells, facets, markers)), NAMES)


def bent_tube() -> Any:
    """A tube of radius 1: a leg along x, a quarter bend of radius 3, a leg along y."""
    first = occ.Cylinder(occ.Pnt(-5, 0, 0), occ.X, r=1, h=5)
    circle = occ.WorkPlane(occ.Axes((0, 0, 0), n=occ.X, h=occ.Y)).Circle(1).Face()
    bend = circle.Revolve(occ.Axis(occ.Pnt(0, 3, 0), occ.Z), 90)
    shape = first + bend + occ.Cylinder(occ.Pnt(3, 3, 0), occ.Y, r=1, h=4)
    for face in shape.faces:
        face.name = "inlet" if face.center.x < -4.99 else "outlet" if face.center.y > 6.99 else "wall"
    return shape


def tetrapod() -> Any:
    """Four legs in a ball, with round ends."""
    shape = occ.Sphere(occ.Pnt(0, 0, 0), 0.16)
    for x, y, z in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)):
        shape += occ.Cylinder(occ.Pnt(0, 0, 0), occ.Dir(x, y, z), r=0.09, h=0.36)
        shape += occ.Sphere(occ.Pnt(*(0.36 * np.array([x, y, z]) / np.sqrt(3.0))), 0.09)
    return shape


def bolt() -> Any:
    """A hexagonal head on a shaft."""
    corners = [(0.26 * np.cos(a), 0.26 * np.sin(a)) for a in np.arange(6) * np.pi / 3.0]
    path = occ.WorkPlane().MoveTo(*corners[0])
    for corner in corners[1:]:
        path = path.LineTo(*corner)
    return path.Close().Face().Extrude(0.18) + occ.Cylinder(occ.Pnt(0, 0, 0), -occ.Z, r=0.12, h=0.5)


def write_stl(path: Path, shape: Any, size: float) -> None:
    """The triangles of a shape's surface, as bytes."""
    netgen = netgen_mesh(shape, 3, EdgeLengths(size, 0.4), surfaces_alone=True)
    corners = netgen.Coordinates()[elements(netgen.Elements2D(), 3)[0]]
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])
    triangles = np.zeros(len(corners), dtype=record)
    triangles["corners"] = corners
    path.write_bytes(bytes(80) + len(triangles).to_bytes(4, "little") + triangles.tobytes())


if __name__ == "__main__":
    meshing.SetMessageImportance(0)
    write_vessel()
    bent_tube().WriteStep(str(FOLDER / "bent_tube.step"))
    write_stl(FOLDER / "tetrapod.stl", tetrapod(), 0.1)
    write_stl(FOLDER / "bolt.stl", bolt(), 0.12)
