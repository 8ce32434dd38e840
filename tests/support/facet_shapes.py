"""Polygons and polyhedra for tests, and the STL files of the latter."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rigidfluid.bodies.polygon import Polygon, PolygonOptions
from rigidfluid.bodies.polyhedron import Polyhedron, PolyhedronOptions

SQUARE = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
L_SHAPE = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]]
BAR = [[-1.0, -0.1], [1.0, -0.1], [1.0, 0.1], [-1.0, 0.1]]

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
SQUARES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TRIANGLES = [[a, b, c] for a, b, c, _ in SQUARES] + [[a, c, d] for a, _, c, d in SQUARES]
"""Of the cube, going round to the left seen from outside."""

NOTCHED = np.vstack([CUBE * [2.0, 1.0, 0.7], [0.8, 0.5, 0.3]])
NOTCHED_TRIANGLES = [
    *([a, b, c] for a, b, c, _ in SQUARES[:5]),
    *([a, c, d] for a, _, c, d in SQUARES[:5]),
    *([1, 5, 8], [5, 7, 8], [7, 3, 8], [3, 1, 8]),
]
"""A box, longer than wide, whose top goes in to a point."""


def polygon(corners: Any) -> Polygon:
    return Polygon(PolygonOptions(points=np.asarray(corners, dtype=float).tolist()), 2)


def polyhedron(path: Path, scale: float = 1.0) -> Polyhedron:
    return Polyhedron(PolyhedronOptions(file=str(path), scale=scale), 3)


def binary_stl(path: Path, points: Any, triangles: Sequence[Sequence[int]]) -> Path:
    rows = [struct.pack("<12fH", 0, 0, 0, *np.ravel(np.asarray(points)[corners]), 0) for corners in triangles]
    path.write_bytes(bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows))
    return path


def text_stl(path: Path, points: np.ndarray, triangles: Sequence[Sequence[int]]) -> Path:
    lines = ["solid"]
    for corners in points[np.array(triangles)].tolist():
        vertices = [f"vertex {x!r} {y!r} {z!r}" for x, y, z in corners]
        lines += ["facet normal 0 0 0", "outer loop", *vertices, "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid\n"]), encoding="ascii")
    return path
