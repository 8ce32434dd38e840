"""Shapes that are drawn and written to CAD files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rigidfluid.domains.cad import Cad, CadOptions


def bent_tube() -> Any:
    """A tube of radius 1: a leg of length 4 along z, a quarter bend of radius 3, a leg of length 4 along x."""
    from netgen import occ

    first = occ.Cylinder(occ.Pnt(0, 0, 0), occ.Z, 1, 4)
    disk = occ.WorkPlane(occ.Axes(occ.Pnt(0, 0, 4), occ.Z, occ.X)).Circle(1).Face()
    bend = disk.Revolve(occ.Axis(occ.Pnt(3, 0, 4), occ.Y), 90)
    tube = first + bend + occ.Cylinder(occ.Pnt(3, 0, 7), occ.X, 1, 4)
    tube.faces.name = "wall"
    tube.faces.Min(occ.Z).name = "inflow"
    tube.faces.Max(occ.X).name = "outflow"
    return tube


def ball_in_a_box() -> Any:
    """A cube of length 2 about the origin, with a ball of radius 0.5 in its middle left out."""
    from netgen import occ

    box = occ.Box(occ.Pnt(-1, -1, -1), occ.Pnt(1, 1, 1))
    box.faces.name = "box"
    ball = occ.Sphere(occ.Pnt(0, 0, 0), 0.5)
    ball.faces.name = "ball"
    return box - ball


def plate() -> Any:
    """A rectangle of 4 × 2 with a round hole of radius 0.3 about (1, 1), in the plane."""
    from netgen import occ

    sheet = occ.WorkPlane().Rectangle(4, 2).Face()
    for side, name in zip(sheet.edges, ("bottom", "right", "top", "left"), strict=True):
        side.name = name
    hole = occ.WorkPlane().Circle(1, 1, 0.3).Face()
    hole.edges.name = "hole"
    return sheet - hole


def straight(corners: Sequence[Sequence[float]]) -> Any:
    """The polygon through corners (N, 2), each side with a name of its own."""
    from netgen import occ

    path = occ.WorkPlane().MoveTo(*corners[0])
    for number, corner in enumerate([*corners[1:], corners[0]]):
        path = path.LineTo(*corner, f"side {number}")
    return path.Face()


def polyhedron(corners: Sequence[Sequence[float]], faces: Sequence[Sequence[int]]) -> Any:
    """The solid between flat faces through some of the corners (N, 3), each face with a name of its own."""
    from netgen import occ

    points = [occ.Pnt(*corner) for corner in corners]
    around = [zip(face, (*face[1:], face[0]), strict=True) for face in faces]
    wires = [occ.Wire([occ.Segment(points[a], points[b]) for a, b in edges]) for edges in around]
    solid = occ.Solid(occ.Glue([occ.Face(wire) for wire in wires]))
    for number, face in enumerate(solid.faces):
        face.name = f"side {number}"
    return solid


def oblique_tube() -> Any:
    """A tube of radius 1 along z, between two planes that lie across no axis."""
    from netgen import occ

    tube = occ.Cylinder(occ.Pnt(0, 0, -2), occ.Z, 1, 4)
    tube.faces.name = "wall"
    tube = tube * occ.HalfSpace(occ.Pnt(0, 0, 1), occ.Vec(0.3, 0.5, 1.0))
    tube = tube * occ.HalfSpace(occ.Pnt(0, 0, -1), occ.Vec(0.6, -0.1, -1.0))
    for face in tube.faces:
        if face.name != "wall":
            face.name = "top" if face.center.z > 0.0 else "bottom"
    return tube


def written(shape: Any, folder: Path, name: str = "shape.step") -> str:
    """The path of a file with the shape, as its ending says."""
    path = str(folder / name)
    shape.WriteBrep(path) if name.endswith("brep") else shape.WriteStep(path)
    return path


def drawn(shape: Any, folder: Path, dimension: int = 3, **keys: Any) -> Cad:
    """The domain of a shape that has been written and read back."""
    return Cad(CadOptions(file=written(shape, folder), **keys), dimension)
