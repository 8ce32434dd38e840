"""Fields and points for ParaView: VTU files of each output time, and a PVD file that lists them.

If ranks share the mesh, each writes a VTU file of its cells, and a PVTU file lists those of one time.
"""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.types import Fields, InsideFields
from rigidfluid.core.output.cell_gradients import nodal_shear_rate, nodal_vorticity
from rigidfluid.core.output.disk import open_new, replace_text
from rigidfluid.core.output.result_file import require_result
from rigidfluid.errors import OutputError

FLUID, BODIES, CONTACTS, INSIDES = DATASETS = "fluid", "bodies", "contacts", "insides"
"""Names of the data sets of an output time; the number of its part in a PVD file is its place here."""

QUADRATIC = {6: 22, 10: 24}  # VTK's numbers for the quadratic triangle and tetrahedron
_DIMENSIONS = {6: 2, 10: 3}
_TYPES = {"f4": "Float32", "f8": "Float64", "i8": "Int64", "u1": "UInt8"}
_HEADER = 8  # bytes that say how long an array is


def write_vtu(path: Path, fields: Fields) -> None:
    """Write quadratic cells with `nodal_arrays` of their nodes, and ``cell_errors`` of the cells if they are known."""
    single = {name: values.astype("<f4") for name, values in nodal_arrays(fields).items()}
    of_cells = {} if fields.cell_errors is None else {"cell_errors": fields.cell_errors.astype("<f4")}
    write_grid(path, fields.points, (QUADRATIC[fields.cells.shape[1]], fields.cells), single, of_cells)


def nodal_arrays(fields: Fields) -> dict[str, FloatArray]:
    """Arrays at the nodes as ParaView takes them: ``velocity`` (N, 3), ``pressure`` (N,) and ``vorticity``, (N,) in 2D
    and (N, 3) in 3D, ``scalar`` (N,) if there is one, and ``viscosity`` and ``shear_rate`` (N,) where it varies."""
    scalar = {} if fields.scalar is None else {"scalar": fields.scalar}
    viscosity = (
        {} if fields.viscosity is None else {"viscosity": fields.viscosity, "shear_rate": nodal_shear_rate(fields)}
    )
    return {
        "velocity": in_space(fields.velocity),
        "pressure": fields.pressure,
        "vorticity": np.squeeze(nodal_vorticity(fields), axis=1 if fields.points.shape[1] == 2 else ()),
        **scalar,
        **viscosity,
    }


def write_grid(
    path: Path,
    points: FloatArray,
    cells: tuple[int, IntArray],
    arrays: Mapping[str, NDArray[np.generic]],
    cell_arrays: Mapping[str, NDArray[np.generic]] = MappingProxyType({}),
) -> None:
    """Write ``points`` (N, d) with ``arrays`` by name, (N,) or (N, components), and ``cells``, all of one kind: VTK's
    number of it, and their points (M, b), with ``cell_arrays`` (M,) by name."""
    kind, corners = cells
    count, width = corners.shape
    root = ET.Element(
        "VTKFile", type="UnstructuredGrid", version="1.0", byte_order="LittleEndian", header_type="UInt64"
    )
    piece = ET.SubElement(
        ET.SubElement(root, "UnstructuredGrid"), "Piece", NumberOfPoints=str(len(points)), NumberOfCells=str(count)
    )
    data_array(ET.SubElement(piece, "Points"), "points", in_space(points).astype("<f8"))
    topology = ET.SubElement(piece, "Cells")
    data_array(topology, "connectivity", corners.astype("<i8").ravel())
    data_array(topology, "offsets", np.arange(width, width * count + 1, width, dtype="<i8"))
    data_array(topology, "types", np.full(count, kind, dtype="u1"))
    data = ET.SubElement(piece, "PointData")
    for name, values in arrays.items():
        data_array(data, name, values)
    for name, values in cell_arrays.items():
        data_array(ET.SubElement(piece, "CellData"), name, values)
    _write(path, root)


def _write(path: Path, root: ET.Element) -> None:
    with open_new(path) as file:
        ET.ElementTree(root).write(file, encoding="utf-8", xml_declaration=True)


def write_pvtu(path: Path, pieces: Sequence[str], fields: Fields) -> None:
    """List the VTU files of one time, their names relative to this one's folder; all have what the ``fields`` have."""
    root = ET.Element(
        "VTKFile", type="PUnstructuredGrid", version="1.0", byte_order="LittleEndian", header_type="UInt64"
    )
    grid = ET.SubElement(root, "PUnstructuredGrid", GhostLevel="0")
    points = ET.SubElement(grid, "PPoints")
    ET.SubElement(points, "PDataArray", type="Float64", Name="points", NumberOfComponents="3")
    data = ET.SubElement(grid, "PPointData", Vectors="velocity", Scalars="pressure")
    cell = fields.cells[:1]
    for name, values in nodal_arrays(fields.part(cell.ravel(), np.arange(cell.size).reshape(cell.shape))).items():
        components = str(int(np.prod(values.shape[1:])))
        ET.SubElement(data, "PDataArray", type="Float32", Name=name, NumberOfComponents=components)
    for piece in pieces:
        ET.SubElement(grid, "Piece", Source=piece)
    _write(path, root)


def write_pvd(path: Path, times: Sequence[float], series: Sequence[Mapping[str, str]]) -> None:
    """List the files of each time by what is in them, one of DATASETS; ParaView opens them as one series of blocks of
    these names, the mesh changing in time."""
    root = ET.Element("VTKFile", type="Collection", version="1.0", byte_order="LittleEndian")
    collection = ET.SubElement(root, "Collection")
    for time, files in zip(times, series, strict=True):
        for name, file in files.items():
            part = str(DATASETS.index(name))
            ET.SubElement(collection, "DataSet", timestep=repr(time), part=part, name=name, file=file)
    replace_text(path, ET.tostring(root, encoding="utf-8", xml_declaration=True).decode())


def read_vtu(path: Path) -> Fields:
    """Read back what `write_vtu` has written; velocity and pressure are as precise as on disk, 7 digits.

    The pieces that a PVTU file lists become one mesh. Raises OutputError where the file is missing or is not of that
    kind.
    """
    if path.suffix == ".pvtu":
        with _reading(path):
            pieces = [path.parent / piece.attrib["Source"] for piece in ET.parse(path).iter("Piece")]
        return _joined([read_vtu(piece) for piece in pieces])
    with _reading(path):
        points, cells, arrays = _grid(path)
        nodes, dimension = points.shape
        return Fields(
            points=points,
            cells=cells,
            velocity=arrays["velocity"].reshape(nodes, 3)[:, :dimension].astype(np.float64),
            pressure=arrays["pressure"].reshape(nodes).astype(np.float64),
            **{
                name: arrays[name].reshape(nodes).astype(np.float64)
                for name in ("scalar", "viscosity")
                if name in arrays
            },
            cell_errors=arrays["cell_errors"].astype(np.float64) if "cell_errors" in arrays else None,
        )


def read_insides(path: Path) -> InsideFields:
    """Read back the scalar inside bodies; raises OutputError where the file is missing or is not of that kind."""
    with _reading(path):
        points, cells, arrays = _grid(path)
        return InsideFields(points, cells, arrays["scalar"].astype(np.float64), arrays["body"].astype(np.int64))


def _grid(path: Path) -> tuple[FloatArray, IntArray, dict[str | None, NDArray[Any]]]:
    """Points (N, d) and quadratic cells (M, 6 | 10) of a VTU file, and all its arrays by name."""
    arrays = {array.get("Name"): _values(array) for array in ET.parse(path).iter("DataArray")}
    cells = arrays["connectivity"].reshape(len(arrays["types"]), -1).astype(np.int64)
    return arrays["points"][:, : _DIMENSIONS[cells.shape[1]]].astype(np.float64), cells, arrays


def read_pvd(path: Path, name: str = FLUID) -> tuple[tuple[float, Path], ...]:
    """Times and files of one of DATASETS in a series, in order; raises OutputError where the list is missing or cannot
    be read."""
    with _reading(path):
        part = str(DATASETS.index(name))
        sets = [entry for entry in ET.parse(path).iter("DataSet") if entry.attrib["part"] == part]
        return tuple((float(entry.attrib["timestep"]), path.parent / entry.attrib["file"]) for entry in sets)


def _joined(pieces: Sequence[Fields]) -> Fields:
    """Join pieces to one mesh, with a single node where several have the same to rounding."""
    from scipy.spatial import cKDTree

    points = np.concatenate([piece.points for piece in pieces])
    first = np.cumsum([0, *(len(piece.points) for piece in pieces)])
    cells = np.concatenate([piece.cells + start for piece, start in zip(pieces, first[:-1], strict=True)])
    same = cKDTree(points).query_pairs(1e-9 * float(np.ptp(points)), output_type="ndarray")
    stands_for = np.arange(len(points))
    np.minimum.at(stands_for, same[:, 1], same[:, 0])
    kept, number = np.unique(stands_for, return_inverse=True)
    values = [piece.nodal_values for piece in pieces]
    every = {name: np.concatenate([each[name] for each in values]) for name in values[0]}
    return Fields(**every, cells=cells).part(kept, number[cells])


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Turn what is wrong with a file into an OutputError that names it."""
    require_result(path)
    try:
        yield
    except (OSError, ET.ParseError, KeyError, ValueError) as error:
        raise OutputError(
            str(path),
            f"a file that cannot be read ({type(error).__name__}: {error})",
            "a file that rigidfluid has written",
            "Run the scene again, or go on with --resume.",
        ) from error


def _values(element: ET.Element) -> NDArray[Any]:
    """The numbers of one inline binary array, (N,) or (N, components)."""
    raw = base64.b64decode(element.text or "", validate=True)
    if len(raw) < _HEADER or len(raw) != _HEADER + int.from_bytes(raw[:_HEADER], "little"):
        raise ValueError(f"array {element.get('Name')} is cut off")
    kind = {vtk: numpy for numpy, vtk in _TYPES.items()}[element.attrib["type"]]
    values = np.frombuffer(raw, dtype="<" + kind, offset=_HEADER)
    components = element.get("NumberOfComponents")
    return values if components is None else values.reshape(-1, int(components))


def data_array(parent: ET.Element, name: str, values: NDArray[np.generic]) -> None:
    """Add numbers to an element, inline and binary, (N,) or (N, components)."""
    kind = _TYPES[values.dtype.str[1:]]
    element = ET.SubElement(parent, "DataArray", type=kind, Name=name, format="binary")
    if values.ndim == 2:
        element.set("NumberOfComponents", str(values.shape[1]))
    raw = np.ascontiguousarray(values).tobytes()
    element.text = base64.b64encode(len(raw).to_bytes(_HEADER, "little") + raw).decode("ascii")


def in_space(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """ParaView's points and vectors have three components."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))
