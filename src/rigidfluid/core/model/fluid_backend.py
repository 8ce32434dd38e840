"""Abstract class of a fluid backend."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import ClassVar

import numpy as np
from scipy.sparse import csc_array

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Material, Newtonian
from rigidfluid.core.geometry.answers import anything, instance, number, optional, rows, several
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.guarded import gives
from rigidfluid.core.model import backend_answers as backends
from rigidfluid.core.model.extension import Extension, FactorisedExtension
from rigidfluid.core.model.flow_error import ErrorRate, MeshVelocity, RefinedFlow, Refinement
from rigidfluid.core.model.neighbour_step import NeighbourEnd, NeighbourPair, NeighbourStep
from rigidfluid.core.model.part import Part, PartOptions
from rigidfluid.core.model.ranks import ALONE, Ranks
from rigidfluid.core.model.types import (
    Advance,
    Fields,
    FluidState,
    InsideFields,
    Mesh,
    Pose,
    Response,
    SolverCost,
    Step,
    Twist,
)

Filling = Callable[[FloatArray], tuple[BoolArray, FloatArray]]
"""Whether bodies have left each of some points (N, d), (N,), and the velocity (N, d) that they had there
[length/time]."""


class FluidBackend(Part):
    """Moves fluid and bodies together over one step.

    With several ``ranks`` each process has a backend and a part of each mesh; all methods are called on all ranks
    together, and results that are not fields are the same on all.

    Parameters
    ----------
    options : PartOptions
        The backend's own keys of the ``[fluid]`` table.
    problem : FluidProblem or None
        The fluid's equations and boundary conditions; None where there is no fluid.
    """

    kind: ClassVar[str] = "fluid backend"
    wet: ClassVar[bool] = True
    """Tell whether there is a fluid around the bodies, on a mesh; else it gets meshes without cells."""
    materials: ClassVar[tuple[type[Material], ...]] = (Newtonian,)
    """Materials that it solves for."""
    curved_cells: ClassVar[bool] = False
    """Tell whether it takes meshes with curved edges; else it gets straight ones."""
    initial_flows: ClassVar[bool] = False
    """Tell whether it can start with another `FluidProblem.initial` than rest; else such scenes are refused."""
    oblique_faces: ClassVar[bool] = False
    """Tell whether it takes slip and pressure conditions on faces that lie across no axis."""
    periodic_faces: ClassVar[bool] = False
    """Tell whether it takes periodic conditions."""
    held_fluxes: ClassVar[bool] = False
    """Tell whether it finds the drop of pressure for a flux that is held through periodic faces, and measures both by
    `driving`."""
    scalars: ClassVar[bool] = False
    """Tell whether it solves for a transported scalar; else such scenes are refused."""
    conduction: ClassVar[bool] = False
    """Tell whether it solves for a transported scalar inside bodies too; else bodies that conduct are refused."""
    stresslets: ClassVar[bool] = False
    """Tell whether it gives stresslets of bodies to a `Step` that wants them."""
    boundary_forces: ClassVar[bool] = False
    """Tell whether it gives forces on the domain's boundary to a `Step` that wants them."""
    cell_errors: ClassVar[bool] = False
    """Tell whether it gives errors of cells to a `Step` that wants them."""
    tangents: ClassVar[bool] = False
    """Tell whether it gives `neighbours` of a step, by which sensitivities are found."""
    refinements: ClassVar[bool] = False
    """Tell whether it tells by `refinement` what a finer mesh would change, for error bars."""
    duals: ClassVar[bool] = False
    """Tell whether it gives `force_errors`, by dual flows."""
    state_format: ClassVar[str | None] = None
    """Name of the format of its state. Backends of one format resume each other's runs, and by `joined` and `cut` those
    of other numbers of ranks; None where neither can be."""
    exchanges_bodies: ClassVar[bool] = False
    """Tell whether bodies may enter and leave its fluid, by `with_bodies`."""
    ranks: Ranks = ALONE
    """The processes that share the run."""

    def __init__(self, options: PartOptions, problem: FluidProblem | None) -> None:
        self.options = options
        self.problem = problem

    @gives(anything)
    def extension(self, mesh: Mesh, stiffness: csc_array, held: BoolArray) -> Extension:
        """Solver of Σ stiffness · u = 0 at vertices that are not ``held`` (N,), the sum over all ranks.

        ``stiffness`` (N, N) is symmetric and has this rank's cells alone.
        """
        return FactorisedExtension(stiffness, held)

    @abstractmethod
    @gives(backends.state_and_kinetic)
    def initial(self, mesh: Mesh, pose: Pose, twist: Twist) -> tuple[FluidState, float]:
        """Fluid at the start, by `FluidProblem.initial`, and its kinetic energy [energy].

        A fluid at "rest" was so until its bodies were set in motion with ``twist``.
        """

    @gives(optional(backends.struck))
    def struck(self, mesh: Mesh, pose: Pose, twist: Twist, step: Step) -> tuple[FluidState, float, Twist] | None:
        """The same for a fluid at rest when faces were set in motion as well, with what they have at time 0; and the
        twists of the motions then, free ones by their masses and the fluid's.

        Before, the bodies had ``twist``; the ``step`` is so short that masses alone respond. Without this method such
        a fluid is set in motion by its first step.
        """
        return None

    @abstractmethod
    @gives(backends.advance)
    def advance(self, fluid: FluidState, mesh: Mesh, step: Step) -> Advance:
        """Take one step from ``fluid`` on ``mesh`` to ``step.points``; raises StepRejected where it cannot."""

    @gives(anything)
    def neighbours(
        self, solved: NeighbourStep, found: FluidState, pairs: Sequence[NeighbourPair]
    ) -> list[tuple[NeighbourEnd, NeighbourEnd]]:
        """Ends of ``pairs`` of steps on both sides of one that was ``solved``, whose state at the end was ``found``:
        to first order in their difference, by one linear solution for each pair; asked where there are `tangents`.

        Later steps are as if it had not been asked. Raises StepRejected.
        """
        raise NotImplementedError

    @abstractmethod
    @gives(backends.response)
    def response(self, fluid: FluidState, mesh: Mesh, step: Step, impulses: FloatArray) -> Response:
        """Impulse response: the twists that each of c ``impulses`` (c, n, d+k) on the free bodies gives in this
        ``step`` [force·time | force·length·time]; asked of backends with a mesh alone."""

    @abstractmethod
    @gives(backends.state_and_energy)
    def transfer(self, fluid: FluidState, old: Mesh, new: Mesh) -> tuple[FluidState, float]:
        """The state on another mesh of the same domain at the same time, and the kinetic energy lost [energy]."""

    @gives(backends.state_and_energy)
    def with_bodies(
        self, fluid: FluidState, old: Mesh, new: Mesh, pose: Pose, twist: Twist, filling: Filling
    ) -> tuple[FluidState, float]:
        """The flow of another backend of this class around other bodies, on a mesh around those of this one; and its
        kinetic energy [energy].

        The bodies have this ``pose`` and ``twist``; ``filling(points)`` gives the velocity where others have left. It
        is the flow nearest to the one before, of all that go with the bodies; the state one step earlier is forgotten.
        """
        raise NotImplementedError

    @gives(number(shorter=True))
    def prediction_error(self, before: FluidState, after: FluidState, mesh: Mesh, extrapolation: FloatArray) -> float:
        """Kinetic energy of the difference between a velocity and its extrapolation, ½ρ∫|uⁿ⁺¹ - e₀uⁿ - e₁uⁿ⁻¹|².

        uⁿ⁺¹ is of ``after``, on its ``mesh``, the others are of ``before``; ``extrapolation`` (2,): e. Zero where
        the fluid has no inertia. It is asked for in scenes with ``time.tolerance`` alone; a backend that does not
        measure it leaves the step to the bodies.
        """
        return 0.0

    @abstractmethod
    @gives(backends.fields)
    def fields(self, fluid: FluidState, mesh: Mesh) -> Fields:
        """Velocity and pressure for output."""

    @gives(backends.insides)
    def insides(self, fluid: FluidState, mesh: Mesh, pose: Pose) -> InsideFields | None:
        """The scalar inside the bodies that conduct it, for output; None where there are none.

        All processes are asked, and what the root tells, of all bodies, is written.
        """
        return None

    @abstractmethod
    @gives(backends.probes)
    def probe(self, fluid: FluidState, mesh: Mesh, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Velocity (N, d) and pressure (N,) at ``points`` (N, d); outside the mesh the nearest cell's values."""

    @gives(rows(lambda _, fluid, mesh, pose, points: points.shape[:1], shorter=True))
    def probe_scalar(self, fluid: FluidState, mesh: Mesh, pose: Pose, points: FloatArray) -> FloatArray:
        """The scalar (N,) at ``points`` (N, d), as `probe` gives the rest, but inside bodies that conduct its own;
        asked of backends with `scalars` alone, no numbers of those that do not tell it."""
        return np.full(len(points), np.nan)

    @gives(backends.driving)
    def driving(self, fluid: FluidState, mesh: Mesh) -> FloatArray:
        """Flux into the domain [length^d/time] and mean excess of the pressure [force/length^(d-1)] at the first piece
        of each periodic pair, in the order of their numbers, (c, 2); of no pairs unless it has `held_fluxes`."""
        return np.zeros((0, 2))

    @gives(backends.refinement)
    def refinement(
        self, flow: RefinedFlow, step: Step, rate: ErrorRate | None, mesh_velocity: MeshVelocity
    ) -> Refinement:
        """Change by the finer of two meshes in a ``step`` from ``flow`` that convects with its own solution; its ∂/∂t
        has this ``rate`` besides, and both meshes follow the change of the twists with a ``mesh_velocity``. Asked of
        backends with `refinements` alone.

        The vertices of the ``finer`` one are those of the ``mesh``, then the middles of its edges, in the order of
        their vertices. Raises StepRejected where there is no such solution.
        """
        raise NotImplementedError

    @gives(anything)
    def carried_errors(self, errors: FloatArray, old: RefinedFlow, new: RefinedFlow) -> FloatArray:
        """Errors (o, nodes, d) of the velocity of the ``new`` flow that `transfer` has made of an ``old`` one, which
        had these ``errors``: on finer meshes, with what the transfer has changed; asked where there are
        `refinements`."""
        raise NotImplementedError

    @gives(backends.force_errors)
    def force_errors(self, flow: RefinedFlow, step: Step) -> FloatArray:
        """Parts of the mesh's cells (M,) in the error of the forces on all bodies in a ``step`` from a ``flow`` to
        itself, whose sum is a bound of it [force]; asked of backends with `duals` alone. The ``finer`` mesh is that of
        `refinement`. Raises StepRejected where there is no dual flow."""
        raise NotImplementedError

    @abstractmethod
    @gives(number(-1.0))
    def unknowns(self, mesh: Mesh, prescribed: BoolArray) -> int:
        """Number of unknowns of one step on this mesh, with the twists of the ``prescribed`` motions (N,)
        prescribed."""

    @gives(optional(instance(lambda: SolverCost)))
    def solver_cost(self, cells: float, facets: float) -> SolverCost | None:
        """Expected cost of steps on a mesh of about so many ``cells``, and ``facets`` on its boundary; None where the
        backend does not know."""
        return None

    @abstractmethod
    @gives(anything)
    def forget(self) -> None:
        """Drop every cache, so that the next step depends on the given state alone."""

    @gives(optional(instance(lambda: Mapping)))
    def state_shapes(self, mesh: Mesh, pose: Pose) -> Mapping[str, tuple[int, ...]] | None:
        """Shapes of the arrays of its state on a mesh, with the bodies at a pose, as a checkpoint is to have them; None
        where the backend does not say."""
        return None

    @gives(backends.state)
    def memory(self) -> FluidState:
        """Data on which the next step depends besides the given state, to the last bit: named arrays for a checkpoint.

        A backend that does not say drops its caches.
        """
        self.forget()
        return {}

    @gives(anything)
    def recall(self, memory: FluidState, mesh: Mesh) -> None:
        """Go on from what `memory` gave, here or in another process, when the state was on this ``mesh``."""
        self.forget()

    @gives(backends.state)
    def joined(self, states: Sequence[FluidState], parts: Sequence[Mesh], mesh: Mesh) -> FluidState:
        """The state on a whole ``mesh`` from those on all its ``parts``; asked of the root alone, if there
        is a `state_format`."""
        raise NotImplementedError

    @gives(several(lambda: Mapping))
    def cut(self, fluid: FluidState, mesh: Mesh, parts: Sequence[Mesh]) -> list[FluidState]:
        """The states on all ``parts`` of a whole ``mesh`` from the one there, to the last bit what `joined` takes."""
        raise NotImplementedError
