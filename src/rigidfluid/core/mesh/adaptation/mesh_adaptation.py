"""Decides when a mesh that only moves must be regenerated, and carries the fluid over.

The root makes each mesh and holds it whole meanwhile; every rank moves its own part.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.mesh.adaptation.chosen_cut import well_cut
from rigidfluid.core.mesh.adaptation.coarsening import has_coarsened, is_due, relative_sizes
from rigidfluid.core.mesh.adaptation.crossing import refuse_to_cross
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.adaptation.kept_cells import LAYERS
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.mesh.distribution import distributed, whole
from rigidfluid.core.mesh.flow import Flow, flow_on
from rigidfluid.core.mesh.fluid_domain import FluidDomain, fluid_domain_at
from rigidfluid.core.mesh.generation.coarsen_surface import coarsen_surface
from rigidfluid.core.mesh.generation.curved_cells import CurvedCells
from rigidfluid.core.mesh.generation.curved_edges import with_curved_edges
from rigidfluid.core.mesh.generation.inserter import BY_SHAPE, Inserter
from rigidfluid.core.mesh.mesh_quality import cell_quality, regular_edges
from rigidfluid.core.mesh.size.equidistribution import Equidistribution
from rigidfluid.core.mesh.size.size_field import Sizes, wanted_size
from rigidfluid.core.mesh.size.size_interface import SizeField, with_fields, with_fields_at_rest
from rigidfluid.core.model.flow_error import FlowError, RefinedFlow
from rigidfluid.core.model.mesh_error import ErrorEstimate, ErrorOfFlow
from rigidfluid.core.model.replaceable import Replaceable
from rigidfluid.core.model.state import FailedRemesh, Reference, State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import FluidState, Mesh, Pose
from rigidfluid.core.model.window import CLEARANCE
from rigidfluid.errors import MeshError, StepError, StepRejected

TANGLED = 0.02
"""A mesh with a cell below this quality is not solved on."""

NEARLY_TANGLED = 2.0 * TANGLED
"""A moved mesh is regenerated before a cell tangles, however low a quality is asked for."""


@dataclass(frozen=True)
class Renewal:
    """Conditions on which a mesh is regenerated.

    Its worst cell has fallen below ``quality``, or is nearly tangled, and below half of what it was when made; or it is
    ``oldest`` ticks old; or after some steps with it the cells that an ``accuracy`` demands, if there is one, differ so
    much that a new one is worth it. For ``pause`` ticks, a whole step, after a mesh could not be made, none is tried
    unless a cell is nearly tangled.
    """

    quality: float
    pause: int
    oldest: float = np.inf
    accuracy: Equidistribution | None = None


class MeshUpdater:
    """`Updater` that re-makes the mesh where its quality, its cells' sizes, a gap or its age asks for that.

    Each mesh has the cells that ``fields`` ask for, by the flow on the mesh before; the first one, which ``inserter``
    makes, by a fluid and bodies at rest. All others are made on the conditions of ``renewal``. ``watch`` times a stage
    by its name; the carrying over of the fluid is the stage "transfer". An accuracy is of the error by
    ``estimate``, of the flow if not given.
    """

    needs_remesh = Replaceable()

    def __init__(
        self,
        system: System,
        sizes: Sizes,
        renewal: Renewal,
        fields: Sequence[SizeField] = (),
        inserter: Inserter = BY_SHAPE,
        watch: Callable[[str], AbstractContextManager[None]] = lambda _: nullcontext(),
        estimate: ErrorEstimate | None = None,
    ) -> None:
        self.system = system
        self._sizes = sizes
        self._renewal = renewal
        self._fields = tuple(fields)
        self._inserter = inserter
        self._watch = watch
        self._estimate = ErrorOfFlow() if estimate is None else estimate
        self.needs_remesh = self.is_worn
        self._motion: tuple[MeshMotion, CurvedCells]
        self._reference: Reference | None = None
        self._latest: tuple[Reference, Pose, FloatArray, float] | None = None
        self._made: tuple[Reference, FloatArray] | None = None

    def first_mesh(self) -> Mesh:
        """The mesh around the bodies' initial pose."""
        s, ranks = self.system, self.system.backend.ranks
        with ranks.raise_on_all():
            around = fluid_domain_at(s, s.pose)
            sizes = with_fields_at_rest(self._sizes, self._fields, around)
            mesh = Mesh.empty(s.dimension)
            if ranks.is_root:
                mesh = initial_mesh(around, sizes, self._inserter)
                mesh = self._curved(mesh, around.placed_on(mesh))
        return distributed(mesh, ranks)

    def first_reference(self, mesh: Mesh, gaps: FloatArray) -> Reference:
        """The first mesh as a reference."""
        return reference_of(mesh, self.system.pose, gaps, 0)

    def deform(self, state: State, pose: Pose) -> Mesh:
        """The mesh when the bodies are at ``pose``; raises StepRejected where a cell is tangled."""
        _refuse_to_leave(self.system, pose)
        refuse_to_cross(self.system, pose)
        geometry, worst = self._placed(state.reference, pose)
        if worst < TANGLED:
            raise StepRejected(
                "mesh",
                f"a cell of quality {worst:.3f}",
                f"at least {TANGLED}",
                "If bodies are about to touch, strengthen the contact force; else shorten time.step.",
            )
        return state.reference.mesh.moved_to(geometry)

    def remesh_if_needed(self, state: State, pose: Pose) -> State:
        """The same state, on a new mesh if a step to ``pose`` asks for one; with a mark where none can be made."""
        if state.is_on_new_mesh:
            return state
        if self._waits(state.reference, state, pose) or not self._is_asked_for(state, pose):
            return state
        try:
            mesh = self._remade(state)
        except MeshError as error:
            # The present mesh serves until a cell tangles, and most often a later pose can be meshed.
            return replace(state, remesh_failed=FailedRemesh(state.tick, str(error)))
        with self._watch("transfer"):
            fluid, loss = self.system.backend.transfer(state.fluid, state.mesh, mesh)
            flow_error = self._carried_error(state, fluid, mesh)
        return replace(
            state,
            mesh=mesh,
            reference=reference_of(mesh, state.pose, state.gaps, state.tick),
            fluid=fluid,
            ledger=state.ledger.after_transfer(loss),
            remesh_failed=None,
            cell_errors=None,
            flow_error=flow_error,
        )

    def _carried_error(self, state: State, fluid: FluidState, mesh: Mesh) -> FlowError | None:
        """Errors of a state's flow for the ``fluid`` on a ``mesh`` that was made of it, None where they are unknown."""
        if state.flow_error is None:
            return None
        from rigidfluid.core.mesh.generation.refined_mesh import refined_mesh  # few runs want error bars

        around, flows = fluid_domain_at(self.system, state.pose), ((state.fluid, state.mesh), (fluid, mesh))
        try:
            old, new = (RefinedFlow(flow, on, refined_mesh(on, around.placed_on(on))) for flow, on in flows)
        except MeshError:
            return None
        carried = self.system.backend.carried_errors(state.flow_error.velocity, old, new)
        return replace(state.flow_error, velocity=carried)

    def _is_asked_for(self, state: State, pose: Pose) -> bool:
        """Tell whether the rule of re-meshing, which may be the caller's, says so; raises StepError where it says
        neither."""
        answer = self.needs_remesh(state, pose)
        if not isinstance(answer, bool | np.bool_):
            remedy = "Let it return one of them."
            raise StepError("mesh_updater.needs_remesh", describe(answer), "True or False", remedy)
        return bool(answer)

    def quality(self, state: State) -> float:
        """Quality of the worst cell of the mesh where it is now, curved cells included [1]."""
        return self._placed(state.reference, state.pose)[1]

    def _remade(self, state: State) -> Mesh:
        s, ranks, present = self.system, state.mesh.ranks, whole(state.mesh)
        flow = self._flow(state, self._fields)
        with ranks.raise_on_all():
            made = Mesh.empty(s.dimension)
            if present is not None:
                around = fluid_domain_at(s, present.images_of(state.pose))
                if present.periods is not None:
                    present = well_cut(present, around, self._sizes, present.periods.winding)
                    around = fluid_domain_at(s, present.images_of(state.pose))
                sizes = self._sizes_by(self._fields, around, flow)
                if around.domain.dimension == 3:  # in 2D what gaps leave behind costs next to nothing
                    present = coarsen_surface(present, around, sizes)
                made = self._curved(remesh(present, around, sizes, LAYERS), around)
        return distributed(made, ranks)

    def _flow(self, state: State, fields: Sequence[SizeField]) -> Flow | None:
        """Flow of a ``state`` for size ``fields``, on the root; None without any, and on the other ranks."""
        if not fields:
            return None
        return flow_on(
            self.system.backend, state.fluid, state.mesh, state.twist, self._estimate.error(self.system, state)
        )

    def _sizes_by(self, fields: Sequence[SizeField], around: FluidDomain, flow: Flow | None) -> Sizes:
        """Sizes with what ``fields`` ask for in their ``flow``."""
        return self._sizes if flow is None else with_fields(self._sizes, fields, around, flow)

    def _curved(self, mesh: Mesh, fluid_domain: FluidDomain) -> Mesh:
        """Bend the mesh's edges to the order that is asked for, if the backend takes curved cells."""
        if self._sizes.order == 1 or not self.system.backend.curved_cells:
            return mesh
        return with_curved_edges(mesh, fluid_domain)

    def _waits(self, reference: Reference, state: State, pose: Pose) -> bool:
        """Tell whether a mesh that could not be made shortly before is not worth another try."""
        failed = state.remesh_failed
        if failed is None or state.tick >= failed.tick + self._renewal.pause:
            return False
        return state.tick == failed.tick or self._placed(reference, pose)[1] >= NEARLY_TANGLED

    def is_worn(self, state: State, pose: Pose) -> bool:
        """Tell whether the mesh is old or periods away, a gap has changed since it was made, or a step to ``pose``
        spoils a cell."""
        reference, sizes = state.reference, self._sizes
        if state.tick >= reference.tick + self._renewal.oldest:
            return True
        if self._is_inaccurate(state):
            return True
        if _gap_changed(reference.gaps, state.gaps, sizes).any():
            return True
        if _is_astray(self.system, reference.mesh, pose):
            return True
        points, worst = self._placed(reference, pose)
        lowest = min(max(self._renewal.quality, NEARLY_TANGLED), 0.5 * reference.quality)
        if worst < max(lowest, TANGLED):
            return True
        if not is_due(reference.pose, state.pose, pose, sizes):
            return False
        mesh = reference.mesh
        around = fluid_domain_at(self.system, mesh.images_of(pose))
        now = relative_sizes(points, mesh.cells, around, sizes)
        return has_coarsened(self._sizes_when_made(reference, sizes), now, mesh.ranks)

    def _is_inaccurate(self, state: State) -> bool:
        """Tell whether other cells are worth it for the accuracy, as large as all other sizes let them be."""
        accuracy = self._renewal.accuracy
        steps, age = (tick / self._renewal.pause for tick in (state.tick, state.tick - state.reference.tick))
        if accuracy is None or not self._estimate.is_asked(steps, age):
            return False
        error = self._estimate.error(self.system, state)
        if error is None or not accuracy.is_due(error, age):
            return False
        mesh, fields = state.mesh, [field for field in self._fields if field is not accuracy]
        around = fluid_domain_at(self.system, mesh.images_of(state.pose))
        sizes = self._sizes_by(fields, around, self._flow(state, fields))
        others = wanted_size(mesh.points[mesh.cells].mean(axis=1), around, sizes)
        return accuracy.is_due(error, age, np.maximum(others / regular_edges(mesh.points, mesh.cells), 1.0))

    def _sizes_when_made(self, reference: Reference, sizes: Sizes) -> FloatArray:
        """Relative sizes of the reference's cells, (M,), kept for the next look."""
        if self._made is None or self._made[0] is not reference:
            mesh = reference.mesh
            around = fluid_domain_at(self.system, mesh.images_of(reference.pose))
            self._made = reference, relative_sizes(mesh.points, mesh.cells, around, sizes)
        return self._made[1]

    def _placed(self, reference: Reference, pose: Pose) -> tuple[FloatArray, float]:
        """Geometry (N + K, d) of the mesh when the bodies are at ``pose``, and its worst cell's quality there; those of
        the latest pose are kept, as a step asks for them several times."""
        if self._latest is None or self._latest[0] is not reference or self._latest[1] is not pose:
            motion, curved = self._map(reference)
            geometry = motion.move(reference.mesh.images_of(pose))
            self._latest = reference, pose, geometry, worst_quality(reference.mesh, curved, geometry)
        return self._latest[2:]

    def _map(self, reference: Reference) -> tuple[MeshMotion, CurvedCells]:
        if self._reference is not reference:
            s = self.system
            around = FluidDomain(s.bodies, reference.mesh.images_of(reference.pose), s.domain, s.walls)
            motion = MeshMotion(reference.mesh, around, s.backend.extension, s.window)
            self._motion, self._reference = (motion, CurvedCells(reference.mesh)), reference
        return self._motion


def _is_astray(system: System, mesh: Mesh, pose: Pose) -> bool:
    """Tell whether a body's image on a periodic mesh is more than a period away from the domain."""
    if mesh.periods is None:
        return False
    outside = fluid_domain_at(system, mesh.images_of(pose)).periods_outside()
    return bool((np.abs(outside) > 1).any())


def _refuse_to_leave(system: System, pose: Pose) -> None:
    """Reject a step in which a body comes near an end of the window."""
    if system.window is None:
        return
    left = system.window.left_by(pose, system.bounding_radii)
    if left is not None:
        lower, upper = system.window.interval(pose)
        raise StepRejected(
            f"body {system.surfaces[left]!r}",
            f"its centre at {pose.position[left].tolist()}, where it leaves the window",
            f"at least {CLEARANCE:g} of its radii from {lower:.6g} and {upper:.6g} along {'xyz'[system.window.axis]}",
            "Lengthen domain.window.ahead or domain.window.behind, or follow another body.",
        )


def reference_of(mesh: Mesh, pose: Pose, gaps: FloatArray, tick: int) -> Reference:
    """A new mesh as what later ones are moved from and compared with; ``gaps`` (n,) when it was made [length]."""
    return Reference(mesh, pose, gaps, worst_quality(mesh, CurvedCells(mesh), mesh.geometry), tick)


def worst_quality(mesh: Mesh, curved: CurvedCells, geometry: FloatArray) -> float:
    """Quality of the worst cell of the whole mesh, also of its ``curved`` cells, at a ``geometry`` (N + K, d) [1]."""
    worst = cell_quality(geometry, mesh.cells).min()
    return float(mesh.ranks.min(min(worst, curved.quality(geometry).min(initial=1.0))))


def _gap_changed(before: FloatArray, now: FloatArray, sizes: Sizes) -> BoolArray:
    """Tell whether each gap that the mesh must resolve has halved, or opened to four times, since the mesh was made,
    (n,)."""
    finest, coarsest = sizes.cells_per_gap * sizes.smallest, 2.0 * sizes.cells_per_gap * sizes.size_body
    ratio = np.clip(now, finest, coarsest) / np.clip(before, finest, coarsest)
    return (ratio < 0.5) | (ratio > 4.0)
