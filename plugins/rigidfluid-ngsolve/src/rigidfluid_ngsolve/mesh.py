"""An NGSolve mesh on the cells and nodes of a Taylor–Hood numbering."""

from __future__ import annotations

from typing import Any

import numpy as np

from rigidfluid.api import FloatArray
from rigidfluid.taylor_hood.elements.numbering import EDGES, Numbering

# Netgen's quadratic cells: the edges of a triangle or tetrahedron in the order of the nodes at their midpoints.
_NETGEN_EDGES = {2: ((1, 2), (0, 2), (0, 1)), 3: ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))}


class NodeMesh:
    """Netgen's quadratic cells over all nodes of ``numbering``, so that nodal spaces on them have its numbers.

    The cells at curved edges are declared ``curved``; NGSolve maps the others from their vertices alone.
    """

    def __init__(self, numbering: Numbering) -> None:
        import netgen.meshing as netgen
        from ngsolve import BitArray, Mesh

        d = numbering.dimension
        made = netgen.Mesh(dim=d)
        if d == 2:
            made.Add(netgen.FaceDescriptor(surfnr=1, domin=1, bc=1))
        made.AddPoints(np.zeros((numbering.nodes, 3)))
        order = [*range(d + 1), *(d + 1 + EDGES[d].index(edge) for edge in _NETGEN_EDGES[d])]
        made.AddElements(dim=d, index=1, data=numbering.cell_nodes[:, order].astype(np.int32))
        curved = np.isin(np.arange(len(numbering.cells)), numbering.curved_cells)
        (made.Elements2D() if d == 2 else made.Elements3D()).NumPy()["curved"] = curved
        self.ngsolve: Any = Mesh(made)
        self.curved: Any = BitArray(curved.tolist())
        self._numbering = numbering
        self._coordinates: FloatArray = made.Coordinates()

    def move(self, points: FloatArray) -> None:
        """Put the mesh where its geometry is ``points`` (vertices + K, d)."""
        self._coordinates[:] = self._numbering.node_points(points)
