"""Output of a backend: fields, probes and the number of unknowns of a state; and its extension over a mesh."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.adaptation.mesh_motion import stiffness
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import box, box_with_balls, samples
from rigidfluid.testing.fluid.exact import LinearFlow, enclosed, problem


class OutputContract(FluidContract):
    """Different views of one state agree."""

    def test_fields_are_what_probes_find(self, dimension: int) -> None:
        """Probes at the nodes give the nodal values."""
        flow = self.stirred(dimension, steps=2)
        fields = flow.backend.fields(flow.fluid, flow.mesh)
        assert np.abs(fields.velocity).max() > 0.1
        velocity, pressure = flow.probe(fields.points)
        self.assert_close(velocity, fields.velocity)
        self.assert_close(pressure, fields.pressure, scale=10.0)

    def test_cells_of_the_fields_fill_the_mesh(self, dimension: int) -> None:
        """Quadratic cells in VTK's order: after its corners a node in the middle of each edge."""
        flow = self.stirred(dimension, steps=1)
        fields = flow.backend.fields(flow.fluid, flow.mesh)
        corners = fields.cells[:, : dimension + 1]
        volume = np.abs(cell_volumes(fields.points, corners)).sum()
        self.assert_close(volume, np.abs(cell_volumes(flow.mesh.points, flow.mesh.cells)).sum())
        edges = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))[: len(list(combinations(range(dimension + 1), 2)))]
        for node, (a, b) in enumerate(edges, start=dimension + 1):
            middle = 0.5 * (fields.points[corners[:, a]] + fields.points[corners[:, b]])
            self.assert_close(fields.points[fields.cells[:, node]], middle)

    def test_probes_outside_give_what_is_near(self, dimension: int) -> None:
        """A point outside by round-off has the value on the face; one further out, a value in the nearest cell."""
        exact = LinearFlow.steady(dimension)
        flow = self.empty(enclosed(dimension, exact.velocity, exact.source), box(dimension, 3)).after(None)
        for distance in (1e-9, 3.0):
            for axis in range(dimension):
                outside, on_face = samples(dimension), samples(dimension)
                outside[:, axis], on_face[:, axis] = 1.0 + distance, 1.0
                velocity, pressure = flow.probe(outside)
                assert np.all(np.abs(velocity - exact.velocity(0.0, on_face)) <= _reach(exact.gradient, distance))
                assert np.all(np.abs(pressure - exact.pressure(0.0, on_face)) <= _reach(exact.slope[None], distance))

    def test_a_free_body_has_its_twist_as_unknowns(self, dimension: int) -> None:
        """d + k more for each that is not prescribed; and more on a finer mesh."""
        backend = self.make_backend(problem(dimension, bodies=2))
        mesh, size = self.make_mesh(box_with_balls(dimension)), 3 if dimension == 2 else 6
        held = backend.unknowns(mesh, np.array([True, True]))
        assert backend.unknowns(mesh, np.array([True, False])) == held + size
        assert backend.unknowns(mesh, np.array([False, False])) == held + 2 * size
        empty = self.make_backend(problem(dimension))
        counts = [empty.unknowns(self.make_mesh(box(dimension, n)), np.zeros(0, dtype=bool)) for n in (2, 3)]
        assert 0 < 2 * counts[0] < counts[1]

    def test_an_extension_is_harmonic(self, dimension: int) -> None:
        """Linear values on the faces become linear inside, where all cells are of one size."""
        backend = self.make_backend(problem(dimension))
        mesh = self.make_mesh(box(dimension, 4))
        held = np.any((mesh.points < 1e-9) | (mesh.points > 1.0 - 1e-9), axis=1)
        expected = mesh.points @ np.arange(1.0, dimension + 1) - 0.7
        values = np.where(held, expected, 0.0)
        backend.extension(mesh, stiffness(mesh), held).fill(values)
        self.assert_close(values, expected)


def _reach(slopes: FloatArray, distance: float) -> FloatArray:
    """How far a linear field may differ from that on the face: by round-off, or by what a cell of 1/3 spans."""
    return np.asarray(np.abs(slopes).sum(axis=1) * (0.0 if distance < 1e-6 else 2.0 / 3.0) + 1e-6)
