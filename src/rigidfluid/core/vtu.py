"""Fields for ParaView: one VTU file per output time on the mesh of that time, and a PVD file that lists them."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.types import Fields

_QUADRATIC = {6: 22, 10: 24}  # VTK's numbers for the quadratic triangle and tetrahedron
_TYPES = {"f4": "Float32", "f8": "Float64", "i8": "Int64", "u1": "UInt8"}


def write_vtu(path: Path, fields: Fields) -> None:
    """Write quadratic cells with ``velocity`` (3 components) and ``pressure`` at their nodes."""
    nodes, cells = len(fields.points), len(fields.cells)
    root = ET.Element(
        "VTKFile", type="UnstructuredGrid", version="1.0", byte_order="LittleEndian", header_type="UInt64"
    )
    piece = ET.SubElement(
        ET.SubElement(root, "UnstructuredGrid"), "Piece", NumberOfPoints=str(nodes), NumberOfCells=str(cells)
    )
    _array(ET.SubElement(piece, "Points"), "points", _in_space(fields.points).astype("<f8"))
    topology = ET.SubElement(piece, "Cells")
    width = fields.cells.shape[1]
    _array(topology, "connectivity", fields.cells.astype("<i8").ravel())
    _array(topology, "offsets", np.arange(width, width * cells + 1, width, dtype="<i8"))
    _array(topology, "types", np.full(cells, _QUADRATIC[width], dtype="u1"))
    data = ET.SubElement(piece, "PointData", Vectors="velocity", Scalars="pressure")
    _array(data, "velocity", _in_space(fields.velocity).astype("<f4"))
    _array(data, "pressure", fields.pressure.astype("<f4"))
    ET.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def write_pvd(path: Path, times: Sequence[float], files: Sequence[str]) -> None:
    """List VTU files with their times; ParaView opens them as one series, the mesh changing in time."""
    root = ET.Element("VTKFile", type="Collection", version="1.0", byte_order="LittleEndian")
    collection = ET.SubElement(root, "Collection")
    for time, file in zip(times, files, strict=True):
        ET.SubElement(collection, "DataSet", timestep=repr(time), part="0", file=file)
    ET.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def _array(parent: ET.Element, name: str, values: NDArray[np.generic]) -> None:
    kind = _TYPES[values.dtype.str[1:]]
    element = ET.SubElement(parent, "DataArray", type=kind, Name=name, format="binary")
    if values.ndim == 2:
        element.set("NumberOfComponents", str(values.shape[1]))
    raw = np.ascontiguousarray(values).tobytes()
    element.text = base64.b64encode(len(raw).to_bytes(8, "little") + raw).decode("ascii")


def _in_space(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """ParaView's points and vectors have three components."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))
