"""Reads a mesh file: points, cells of each dimension, and the numbers and names that the file gives them."""

from __future__ import annotations

import contextlib
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.stl_file import read_stl
from rigidfluid.core.mesh.generation.meshing import elements
from rigidfluid.domains.trial import require_survival
from rigidfluid.errors import SceneError
from rigidfluid.regular_file import MOST_GEOMETRY, require_regular

FIELD = "domain.file"
_SIMPLICES = {"vertex": 0, "line": 1, "line3": 1, "triangle": 2, "triangle6": 2, "tetra": 3, "tetra10": 3}
"""Dimension of each kind of cell, of which the corners are taken."""

_NUMBERS = ("gmsh:physical", "cell_tags", "medit:ref")
"""Names in meshio of the numbers of cells; in other formats these are the only data of whole numbers."""

_NETGEN = (".vol", ".vol.gz")
_FORMATS = (".msh", ".med", ".vtu", ".mesh", ".meshb", ".stl", *_NETGEN)


@dataclass(frozen=True)
class Cells:
    """Simplices ``vertices`` (M, k+1) of dimension k, their ``numbers`` (M,), and ``names`` by number."""

    vertices: IntArray
    numbers: IntArray
    names: dict[int, str]


@dataclass(frozen=True)
class MeshFile:
    """All ``points`` (N, 3) of a file, its ``facets`` and its ``cells``, which may be none."""

    points: FloatArray
    facets: Cells
    cells: Cells


def read_mesh(path: Path, dimension: int) -> MeshFile:
    """Read facets and cells of a mesh in 2 or 3 dimensions from a file.

    Formats are Gmsh .msh, MED, .vtu, Medit .mesh or .meshb, Netgen .vol or .vol.gz, and .stl. Raises SceneError if the
    file cannot be read, has other cells than simplices, or needs a package that is not there.
    """
    ending = next((ending for ending in _FORMATS if path.name.lower().endswith(ending)), None)
    require_regular(path, FIELD, MOST_GEOMETRY)
    if ending is None:
        remedy = "Write it in one of those; drawn shapes are read by type = 'cad'."
        raise SceneError(FIELD, str(path), f"one of {', '.join(_FORMATS)}", remedy)
    if ending == ".stl":
        return _mesh_of_stl(path)
    require_survival("mesh", path, dimension)
    return read_untried(path, dimension)


def read_untried(path: Path, dimension: int) -> MeshFile:
    """Read a mesh with a reader of others; a damaged file may end the process, or take all time and memory. Raises
    SceneError."""
    return (_read_by_netgen if path.name.lower().endswith(_NETGEN) else _read_by_meshio)(path, dimension)


def _mesh_of_stl(path: Path) -> MeshFile:
    facets = read_stl(path, FIELD)
    numbers = np.ones(len(facets.vertices), dtype=np.int64)
    return MeshFile(facets.points, Cells(facets.vertices, numbers, {}), _no_cells(3))


def _read_by_netgen(path: Path, dimension: int) -> MeshFile:
    from netgen import meshing

    mesh, verbosity = meshing.Mesh(), meshing.SetMessageImportance(0)
    try:
        mesh.Load(str(path))
    except (meshing.NgException, RuntimeError) as error:
        raise _unreadable(path, error) from error
    finally:
        meshing.SetMessageImportance(verbosity)
    if mesh.dim != dimension or not len(mesh.Points()):
        found = f"{path} with {len(mesh.Points())} points in {mesh.dim} dimensions"
        raise SceneError(FIELD, found, f"a mesh in {dimension} dimensions", "Choose another file or dimension.")
    outer, inner = mesh.Elements1D(), mesh.Elements2D()
    if dimension == 3:
        outer, inner = inner, mesh.Elements3D()
    name_of, cells = (mesh.GetBCName, mesh.GetMaterial), []
    for container, corners, shift in ((outer, dimension, 0), (inner, dimension + 1, 1)):
        vertices, regions = elements(container, corners)
        names = {int(k) + 1: str(name_of[shift](int(k) + shift)) for k in np.unique(regions)}
        cells.append(Cells(vertices, regions + 1, {k: name for k, name in names.items() if name != "default"}))
    return MeshFile(_in_three(mesh.Coordinates()), *cells)


def _read_by_meshio(path: Path, dimension: int) -> MeshFile:
    try:
        import meshio
    except ImportError:
        remedy = "Install it: pip install 'rigidfluid[files]'."
        raise SceneError(FIELD, f"{path}, which meshio would read", "a file that can be read here", remedy) from None
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            mesh = meshio.read(path)
    except (Exception, SystemExit) as error:  # meshio ends the process on some files, and raises anything on others
        raise _unreadable(path, error) from error
    if np.ndim(mesh.points) != 2:
        raise SceneError(FIELD, f"{path} without points", f"a mesh in {dimension} dimensions", "Rewrite it.")
    strange = sorted({block.type for block in mesh.cells} - set(_SIMPLICES))
    if strange:
        found, allowed = f"{path} with cells of type {', '.join(strange)}", "triangles and tetrahedra"
        raise SceneError(FIELD, found, allowed, "Divide them into simplices.")
    numbers, names = _numbers(mesh, path), _names(mesh)
    return MeshFile(_in_three(mesh.points), *(_cells(mesh, numbers, names, k) for k in (dimension - 1, dimension)))


def _in_three(points: Any) -> FloatArray:
    """Points (N, 2) or (N, 3) with three coordinates, (N, 3)."""
    found = np.asarray(points, dtype=float)
    return np.column_stack([found, np.zeros((len(found), 3 - found.shape[1]))])


def _numbers(mesh: Any, path: Path) -> list[IntArray]:
    """Numbers of the cells of each block."""
    whole = [key for key, data in mesh.cell_data.items() if all(_are_whole(block) for block in data)]
    chosen = [key for key in _NUMBERS if key in whole] or whole
    if len(chosen) > 1 and chosen[0] not in _NUMBERS:
        found = f"{path} with whole numbers for cells in {', '.join(chosen)}"
        raise SceneError(FIELD, found, f"one of them, or one called {_NUMBERS[0]!r}", "Leave the others out.")
    if not chosen:
        return [np.zeros(len(block.data), dtype=np.int64) for block in mesh.cells]
    return [np.asarray(data, dtype=np.int64).ravel() for data in mesh.cell_data[chosen[0]]]


def _are_whole(data: Any) -> bool:
    return bool(np.issubdtype(np.asarray(data).dtype, np.integer)) and np.ndim(data) == 1


def _names(mesh: Any) -> dict[int | None, dict[int, str]]:
    """Names by the dimension of the cells that they are for, None of any, and by number."""
    names: dict[int | None, dict[int, str]] = {}
    for name, (number, dimension) in mesh.field_data.items():
        names.setdefault(int(dimension), {})[int(number)] = str(name)
    for number, groups in getattr(mesh, "cell_tags", {}).items():
        names.setdefault(None, {})[int(number)] = str(groups[0])
    return names


def _cells(mesh: Any, numbers: list[IntArray], names: dict[int | None, dict[int, str]], dimension: int) -> Cells:
    chosen = [i for i, block in enumerate(mesh.cells) if _SIMPLICES[block.type] == dimension]
    if not chosen:
        return _no_cells(dimension)
    vertices = np.concatenate([mesh.cells[i].data[:, : dimension + 1] for i in chosen]).astype(np.int64)
    found = np.concatenate([numbers[i] for i in chosen])
    return Cells(vertices, found, {**names.get(None, {}), **names.get(dimension, {})})


def _no_cells(dimension: int) -> Cells:
    return Cells(np.empty((0, dimension + 1), dtype=np.int64), np.empty(0, dtype=np.int64), {})


def _unreadable(path: Path, error: BaseException) -> SceneError:
    found = f"{path}, which cannot be read ({type(error).__name__})"
    return SceneError(FIELD, found, "a whole mesh file of that kind", "Rewrite it.")
