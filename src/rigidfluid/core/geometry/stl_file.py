"""Reads triangles from an STL file, as text or binary."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facets import LARGEST, Facets
from rigidfluid.errors import SceneError
from rigidfluid.regular_file import MOST_GEOMETRY, require_regular

_HEAD = 84
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(path: Path, key: str) -> Facets:
    """Read the triangles of an STL file, at least one, their corners joined where coordinates are equal; normals as the
    corners go round.

    A file with as many bytes as its number of triangles says is binary, all others are text. Raises SceneError, which
    names the scene's ``key``, if the file cannot be read or has no triangles.
    """
    require_regular(path, key, MOST_GEOMETRY)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise SceneError(key, f"{path}: {error.strerror}", "a readable STL file", "Check the path.") from None
    corners = _binary(content) if _is_binary(content) else _text(content, path, key)
    if len(corners) == 0 or not (np.abs(corners) <= LARGEST).all():
        found, allowed = f"{path} with no triangles, or with no numbers", f"triangles, coordinates up to {LARGEST:g}"
        raise SceneError(key, found, allowed, "Rewrite the file.")
    points, numbers = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return Facets(points, numbers.reshape(-1, 3).astype(np.int64), np.zeros(len(corners), dtype=np.int64))


def _is_binary(content: bytes) -> bool:
    if len(content) < _HEAD:
        return False
    count = int.from_bytes(content[_HEAD - 4 : _HEAD], "little")
    return len(content) == _HEAD + count * _TRIANGLE.itemsize


def _binary(content: bytes) -> FloatArray:
    return np.frombuffer(content, dtype=_TRIANGLE, offset=_HEAD)["corners"].astype(float)


def _text(content: bytes, path: Path, key: str) -> FloatArray:
    try:
        return np.fromiter(_coordinates(content), dtype=float).reshape(-1, 3, 3)
    except ValueError:
        remedy = "Rewrite the file, as text or binary."
        raise SceneError(key, f"{path}, which is no STL file", "three vertices a facet", remedy) from None


def _coordinates(content: bytes) -> Iterator[float]:
    """Numbers of all vertices, one at a time: lists of words would take twenty times the file's memory; raises
    ValueError where a vertex has not three."""
    for line in re.finditer(rb"[^\r\n]+", content):
        keyword, *words = line[0].split() or [b""]
        if keyword == b"vertex":
            x, y, z = words
            yield from (float(x), float(y), float(z))
