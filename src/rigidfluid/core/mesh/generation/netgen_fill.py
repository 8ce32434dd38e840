"""Fills a closed surface with simplices by Netgen; run as a process of its own, since Netgen may loop for ever.

    python -m rigidfluid.core.mesh.generation.netgen_fill GIVEN MADE

GIVEN is an NPZ file with ``points`` (N, d), ``facets`` (F, d), their normals into the fluid, ``size`` and ``growth``;
MADE then has ``points`` (M, d) and ``cells`` (C, d+1).
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray


def main(given: str, made: str) -> None:
    """Fill what one file holds and write the cells to the other."""
    from netgen import meshing

    with np.load(given) as arrays:
        points, facets = arrays["points"], arrays["facets"]
        size, growth = float(arrays["size"]), float(arrays["growth"])
    meshing.SetMessageImportance(0)
    parameters = meshing.MeshingParameters(maxh=size, grading=growth, parallel_meshing=False)
    netgen = (filled_plane if points.shape[1] == 2 else filled_space)(points, facets, parameters)
    elements = netgen.Elements2D() if points.shape[1] == 2 else netgen.Elements3D()
    cells = elements.NumPy()["nodes"][:, : points.shape[1] + 1].astype(np.int64) - 1
    np.savez(made, points=netgen.Coordinates()[:, : points.shape[1]], cells=cells)


def filled_plane(points: FloatArray, facets: IntArray, parameters: Any) -> Any:
    """Netgen's triangles between closed loops of edges, each of which stays one edge."""
    from netgen import occ

    vertices = [occ.Pnt(*map(float, point), 0.0) for point in points]
    found = sorted(loops(facets), key=lambda loop: float(np.ptp(points[loop], axis=0).max()))
    wires = [
        occ.Wire([occ.Segment(vertices[a], vertices[b]) for a, b in zip(loop, np.roll(loop, -1), strict=True)])
        for loop in found
    ]
    face = occ.Face(occ.Face(wires[-1]), wires[::-1])  # the plane of the outer loop, bounded by all
    for edge in face.edges:
        edge.partition = np.empty(0)  # no vertices between its ends
    return occ.OCCGeometry(face, dim=2).GenerateMesh(parameters)


def loops(facets: IntArray) -> list[IntArray]:
    """The closed loops that edges (F, 2) make, each as its vertices in order."""
    after = dict(facets.tolist())
    found = []
    while after:
        loop = [next(iter(after))]
        while (following := after.pop(loop[-1])) != loop[0]:
            loop.append(following)
        found.append(np.array(loop))
    return found


def filled_space(points: FloatArray, facets: IntArray, parameters: Any) -> Any:
    """Netgen's tetrahedra between triangles, which stay as they are."""
    from netgen import meshing

    mesh = meshing.Mesh(dim=3)
    numbers = [mesh.Add(meshing.MeshPoint(meshing.Pnt(*map(float, point)))) for point in points]
    side = mesh.Add(meshing.FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
    for facet in facets[:, ::-1]:  # Netgen's normals point out of the fluid
        mesh.Add(meshing.Element2D(side, [numbers[vertex] for vertex in facet]))
    mesh.GenerateVolumeMesh(parameters)
    return mesh


if __name__ == "__main__":
    main(*sys.argv[1:])
