"""A fluid backend for several ranks in which the root does all of scikit-fem's work; each holds a slice of its state.

It is a plug-in: `install_gathered` puts its entry point into a folder for the path.
"""

import os
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.sparse import csc_array

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.mesh.distribution import whole
from rigidfluid.core.model.extension import FactorisedExtension
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.ranks import MpiRanks
from rigidfluid.hookspecs import hookimpl

CURRENT = threading.local()
"""Its ``ranks`` are those of a thread; without them MPI's are taken."""


def install_gathered(folder):
    """Make this module a plug-in of those who have ``folder`` and this file's folder on their path."""
    info = Path(folder) / "gathered-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: gathered\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[rigidfluid]\ngathered = gathered_backend\n")


class Gathered(FluidBackend):
    name = "gathered"
    curved_cells = True
    state_format = "slices"
    Options = ScikitFem.Options

    def __init__(self, options, problem):
        super().__init__(options, problem)
        self.ranks = getattr(CURRENT, "ranks", None) or world()
        self._inner = ScikitFem(options, problem)
        self._meshes = {}
        self._latest = None

    def extension(self, mesh, stiffness, held):
        return OnTheRoot(mesh, stiffness, held) if mesh.part else FactorisedExtension(stiffness, held)

    def initial(self, mesh, pose, twist):
        return self._on_root(lambda mesh: self._inner.initial(mesh, pose, twist), mesh)

    def advance(self, fluid, mesh, step):
        step = self._of_the_whole(mesh, step)
        if os.environ.get("RIGIDFLUID_TEST_FAILING_RANK") == str(self.ranks.rank):
            raise ZeroDivisionError

        def work(mesh, fluid):
            advance = self._inner.advance(fluid, mesh, step)
            return advance.fluid, replace(advance, fluid={})

        fluid, advance = self._on_root(work, mesh, fluid)
        return replace(advance, fluid=fluid)

    def response(self, fluid, mesh, step, impulses):
        step = self._of_the_whole(mesh, step)
        return self._on_root(lambda mesh, fluid: ({}, self._inner.response(fluid, mesh, step, impulses)), mesh, fluid)[
            1
        ]

    def transfer(self, fluid, old, new):
        made = self._whole(new)
        return self._on_root(lambda old, fluid: self._inner.transfer(fluid, old, made), old, fluid)

    def prediction_error(self, before, after, mesh, extrapolation):
        pieces = self.ranks.gather(after)

        def work(mesh, before):
            joined = {name: np.concatenate([piece[name] for piece in pieces]) for name in after}
            return {}, self._inner.prediction_error(before, joined, mesh, extrapolation)

        return self._on_root(work, mesh, before)[1]

    def fields(self, fluid, mesh):
        fields = self._on_root(lambda mesh, fluid: ({}, self._inner.fields(fluid, mesh)), mesh, fluid)[1]
        cells = fields.cells if mesh.part is None else fields.cells[mesh.part.cells]
        nodes, own = np.unique(cells, return_inverse=True)
        return fields.part(nodes, own.reshape(cells.shape))

    def probe(self, fluid, mesh, points):
        return self._on_root(lambda mesh, fluid: ({}, self._inner.probe(fluid, mesh, points)), mesh, fluid)[1]

    def unknowns(self, mesh, prescribed):
        return self._on_root(lambda mesh: ({}, self._inner.unknowns(mesh, prescribed)), mesh)[1]

    def forget(self):
        self._inner.forget()

    def joined(self, states, parts, mesh):
        return {name: np.concatenate([state[name] for state in states]) for name in states[0]}

    def cut(self, fluid, mesh, parts):
        slices = {name: np.array_split(values, len(parts)) for name, values in fluid.items()}
        return [{name: slices[name][rank] for name in slices} for rank in range(len(parts))]

    def _on_root(self, work, mesh, fluid=None):
        """What the root makes of the whole: a state, of which each rank gets a slice, and the rest, for all."""
        mesh, states = self._whole(mesh), self.ranks.gather(fluid)
        slices = rest = None
        with self.ranks.raise_on_all():
            if self.ranks.is_root:
                state, rest = work(mesh, *([] if fluid is None else [self._joined(fluid, states)]))
                cut = {name: np.array_split(values, self.ranks.size) for name, values in state.items()}
                slices = [{name: cut[name][rank] for name in cut} for rank in range(self.ranks.size)]
        return self.ranks.scatter(slices), self.ranks.bcast(rest)

    def _joined(self, fluid, states):
        """The state of all: the same where the root's slice is the same, as a backend knows it by what it is."""
        if self._latest is None or self._latest[0] is not fluid:
            self._latest = fluid, {name: np.concatenate([state[name] for state in states]) for name in fluid}
        return self._latest[1]

    def _of_the_whole(self, mesh, step):
        """The step with all points on the root, of use there alone."""
        if step.points is None:
            return step
        moved = self._whole(mesh.moved_to(step.points))
        return replace(step, points=moved.geometry) if self.ranks.is_root else step

    def _whole(self, mesh):
        """The whole mesh on the root, with the same arrays of cells as long as the part has them."""
        made = whole(mesh)
        if made is None:
            return None
        kept = self._meshes.setdefault(id(mesh.cells), (mesh.cells, made))[1]
        return kept.moved_to(made.geometry)


class OnTheRoot:
    """An extension that the root solves for all."""

    def __init__(self, mesh, matrix, held):
        self._part, self._free = mesh.part, ~held
        entries, ids = matrix.tocoo(), mesh.part.vertices
        sent = (entries.data, ids[entries.coords[0]], ids[entries.coords[1]], ids, held)
        pieces = mesh.ranks.gather(sent)
        if pieces is not None:
            data, rows, columns, vertices, fixed = map(np.concatenate, zip(*pieces, strict=True))
            count = mesh.part.counts[0]
            everywhere = np.zeros(count, dtype=bool)
            everywhere[vertices[fixed]] = True
            self._solver = FactorisedExtension(csc_array((data, (rows, columns)), shape=(count, count)), everywhere)

    def fill(self, values):
        pieces = self._part.ranks.gather((self._part.vertices, values))
        everywhere = None
        if pieces is not None:
            everywhere = np.empty(self._part.counts[0])
            for vertices, given in pieces:
                everywhere[vertices] = given
            self._solver.fill(everywhere)
        values[self._free] = self._part.ranks.bcast(everywhere)[self._part.vertices[self._free]]


def world():
    """The processes of MPI."""
    from mpi4py import MPI

    return MpiRanks(MPI.COMM_WORLD)


@hookimpl
def rigidfluid_fluid_backends():
    return [Gathered]
