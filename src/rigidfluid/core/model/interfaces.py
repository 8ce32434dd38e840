"""Abstract classes of a fluid backend, a detector, a force law, a body type and a mechanism; `domain` has that of a
domain, `core.joints.joint` that of a joint.

Every part names itself (``name``), the packages it needs (``requires``: import name → what to install) and the keys it
reads from its table of the scene file (``Options``). Importing the class must not import those packages.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict
from scipy.sparse import csc_array

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Material, Newtonian
from rigidfluid.core.geometry.answers import anything, instance, number, optional, rows, several
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.guarded import Guarded, gives
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model import backend_answers as backends
from rigidfluid.core.model import part_answers as parts
from rigidfluid.core.model.extension import Extension, FactorisedExtension
from rigidfluid.core.model.ranks import ALONE, Ranks
from rigidfluid.core.model.types import (
    Advance,
    Contacts,
    Fields,
    FluidState,
    Loads,
    Mesh,
    Motion,
    Pose,
    Response,
    SolverCost,
    Step,
    Twist,
)
from rigidfluid.core.scene.table_type import TableType


class PartOptions(BaseModel, metaclass=TableType):
    """The keys that an implementation reads from its table of the scene file; this one reads none."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True)


class Part(metaclass=Guarded):
    """Replaceable part: its name, other words for it, the packages it requires and its options.

    A ``kind`` of parts says with `gives` what its methods give; whoever gives anything else is named.
    """

    kind: ClassVar[str]
    name: ClassVar[str]
    also_called: ClassVar[tuple[str, ...]] = ()
    requires: ClassVar[Mapping[str, str]] = {}
    Options: ClassVar[type[PartOptions]] = PartOptions


class SpatialPart(Part):
    """A part of so many space dimensions, with the options that its table gives it."""

    dimension: int

    def __init__(self, options: PartOptions, dimension: int) -> None:
        self.options = options
        self.dimension = dimension


class Body(Surface, SpatialPart):
    """A rigid shape in its own frame, its centre of mass at the origin.

    Parameters
    ----------
    options : PartOptions
        The type's own keys of the ``[[body]]`` table.
    dimension : int
        2 or 3.
    """

    kind: ClassVar[str] = "body"

    @property
    @abstractmethod
    @gives(number(0.0))
    def volume(self) -> float:
        """Exact volume of the shape (area in 2D) [length^d]."""

    @property
    @abstractmethod
    @gives(parts.inertia)
    def unit_inertia(self) -> FloatArray:
        """Inertia over mass, ∫(|r|² I - r rᵀ) / volume, shape (k, k) [length²]."""

    @property
    @abstractmethod
    @gives(number(0.0))
    def bounding_radius(self) -> float:
        """Radius of the smallest ball about the origin that holds the shape [length]."""

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the cube around the ball of the bounding radius, (d,) each [length]."""
        corner = np.full(self.dimension, self.bounding_radius)
        return -corner, corner

    @property
    @gives(optional(number(0.0)))
    def radius(self) -> float | None:
        """The radius if the shape is a ball, else None [length]."""
        return None

    @property
    @gives(optional(rows(lambda part: (part.dimension,), positive=True)))
    def semi_axes(self) -> FloatArray | None:
        """Semi-axes (d,) along the axes of its frame if the shape is an ellipsoid or a ball, else None [length]."""
        return None if self.radius is None else np.full(self.dimension, self.radius)

    @abstractmethod
    @gives(parts.points)
    def sample_surface(self, count: int) -> FloatArray:
        """Points spread over the surface, about ``count`` of them, (N, d) [length]."""

    @gives(anything)
    def cad_shape(self, unit: float) -> Any:
        """The shape as a ``netgen.occ`` face (2D) or solid (3D), all its lengths over ``unit``, for the mesh generator;
        None with `facets`."""
        return None

    @property
    @gives(optional(parts.facets))
    def facets(self) -> Facets | None:
        """The facets that the shape is made of, in its own frame; None of a smooth one, which has a `cad_shape`."""
        return None

    @property
    @gives(rows(lambda part: (part.dimension,)))
    def given_centre(self) -> FloatArray:
        """Centre of mass in the frame that the options are in, (d,) [length]."""
        return np.zeros(self.dimension)


@dataclass(frozen=True)
class Component:
    """A rigid body in a mechanism: its ``name`` there, its ``shape`` and its ``density`` [mass/length^d]."""

    name: str
    shape: Body
    density: float


class Mechanism(SpatialPart):
    """Several rigid bodies that move as one: freely together, and relatively as a function of time or not at all.

    Parameters
    ----------
    options : PartOptions
        The type's own keys of the ``[[mechanism]]`` table.
    dimension : int
        2 or 3.
    """

    kind: ClassVar[str] = "mechanism"
    driven: bool = False
    """Whether the placement changes with time; else it is asked for once."""

    @property
    @abstractmethod
    @gives(parts.components)
    def components(self) -> Sequence[Component]:
        """Components, m of them; the type of each shape is one that a scene can name."""

    @abstractmethod
    @gives(parts.placement)
    def placement(self, time: float) -> Pose:
        """Pose of the components in the mechanism's own frame, whose origin may be anywhere: m positions [length] and
        orientations [rad | 1]."""

    @gives(parts.rate)
    def rate(self, time: float) -> Twist:
        """Rate of the placement, in the same frame: velocities [length/time] and angular velocities [rad/time]."""
        m, k = len(self.components), 1 if self.dimension == 2 else 3
        return Twist(np.zeros((m, self.dimension)), np.zeros((m, k)))

    @property
    @gives(optional(number(0.0)))
    def period(self) -> float | None:
        """Time after which the placement repeats itself; None where it does not [time]."""
        return None

    @gives(parts.later)
    def next_corner(self, time: float) -> float:
        """The first time after this at which the rate jumps; infinite where it does not [time].

        A step ends there, or less than a tick before, and the next restarts. The rate at a corner is that before it,
        at time 0 that after it.
        """
        return math.inf


class Detector(Part):
    """Finds which surfaces are near each other.

    Parameters
    ----------
    options : PartOptions
        The detector's own keys of the ``[contact]`` table.
    bodies : sequence of Body
        The shapes, in the scene's order.
    walls : sequence of Wall
        The walls that repel; a detector that cannot take a wall of their shape raises SceneError.
    """

    kind: ClassVar[str] = "detector"
    bodies: tuple[Body, ...]
    walls: tuple[Wall, ...]
    needs_mesh: ClassVar[bool] = False
    """Whether it looks at the fluid's mesh; then it is never asked without one."""
    cost: ClassVar[float] = math.inf
    """Time for a near pair over that of `sphere` for two balls [1]; ``auto`` takes the cheapest that is exact."""

    def __init__(self, options: PartOptions, bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
        self.options = options
        self.bodies = tuple(bodies)
        self.walls = tuple(walls)

    @classmethod
    @gives(optional(instance(lambda: str)))
    def exact_for(cls, bodies: Sequence[Body], pieces: Sequence[Piece]) -> str | None:
        """Reason why gaps between these shapes are exact, with a mesh exact to its facets; None if they may not be.

        ``auto`` asks this of every installed detector, and `rigidfluid check` prints "chosen as" and the reason.

        Parameters
        ----------
        bodies : sequence of Body
            The shapes of the scene.
        pieces : sequence of Piece
            The pieces of the domain's boundary.

        Returns
        -------
        str or None
            A clause such as "all bodies are balls"; None, as here, keeps a detector from being chosen.
        """
        return None

    @gives(parts.reach)
    def preferred_reach(self, law_range: float) -> float:
        """The reach that the loop should ask for with a law of this range [length]; infinite if it costs little."""
        return math.inf

    @abstractmethod
    @gives(parts.contacts)
    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b); reach may be infinite."""


class ForceLaw(Part):
    """A short-range force between two surfaces: one that an energy gives, and one that takes energy out.

    All forces act on ``body_a``, half-way between the contact points; ``core/mechanics/wrenches`` applies the reaction.

    Parameters
    ----------
    options : PartOptions
        The law's own keys of the table that names it.
    range : float
        The gap above which the law is zero [length].
    loads : Loads, optional
        What the contacts must hold, for laws that choose their strength by it.
    """

    kind: ClassVar[str] = "force law"
    range: float
    balls_only: ClassVar[bool] = False
    film: bool = False
    """Whether it resists as a film that no mesh resolves: it reads `Contacts.effective_radius`, which balls, ellipses
    and ellipsoids have."""
    conservative: bool = True
    """Whether it has an energy; else force, energy and stiffness are zero."""
    dissipative: bool = False
    """Whether it has damping; else damping is zero."""
    overlap: Literal["repels", "attracts", "unbounded"] = "repels"
    """Behaviour of the energy's force at gap < 0; unbounded: the energy is infinite, and force and stiffness raise
    StepRejected."""
    loads: Loads | None = None
    """Loads from which a law sets its strength; bodies of equal loads then meet alike."""

    def __init__(self, options: PartOptions, range: float, loads: Loads | None = None) -> None:
        self.options = options
        self.range = range

    @property
    @gives(parts.ranges)
    def ranges(self) -> tuple[float, ...]:
        """The gaps where it begins, in order: its range, and those of its parts where it has several [length]."""
        return (self.range,)

    @abstractmethod
    @gives(rows(lambda _, contacts: contacts.normal.shape, shorter=True))
    def force(self, contacts: Contacts) -> FloatArray:
        """Force F = -dU/dgap · n on ``body_a``, (m, d) [force]."""

    @abstractmethod
    @gives(parts.energies)
    def energy(self, contacts: Contacts) -> FloatArray:
        """Potential energy U of each contact, (m,), zero at range [energy]."""

    @abstractmethod
    @gives(rows(lambda _, contacts: contacts.gap.shape, shorter=True))
    def stiffness(self, contacts: Contacts) -> FloatArray:
        """-d(F·n)/dgap of each contact, (m,) [force/length]."""

    @gives(rows(lambda _, contacts, motion: contacts.normal.shape, shorter=True))
    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Further force on ``body_a`` that the relative velocity gives, (m, d), of power ≤ 0 [force]."""
        return np.zeros_like(contacts.normal)


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
    """Whether there is a fluid around the bodies, on a mesh; else it gets meshes without cells."""
    materials: ClassVar[tuple[type[Material], ...]] = (Newtonian,)
    """Materials that it solves for."""
    curved_cells: ClassVar[bool] = False
    """Whether it takes meshes with curved edges; else it gets straight ones."""
    initial_flows: ClassVar[bool] = False
    """Whether it can start with another `FluidProblem.initial` than rest; else such scenes are refused."""
    oblique_faces: ClassVar[bool] = False
    """Whether it takes slip and pressure conditions on faces that lie across no axis."""
    periodic_faces: ClassVar[bool] = False
    """Whether it takes periodic conditions."""
    state_format: ClassVar[str | None] = None
    """Name of the format of its state. Backends of one format resume each other's runs, and by `joined` and `cut` those
    of other numbers of ranks; None where neither can be."""
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

    @abstractmethod
    @gives(backends.response)
    def response(self, fluid: FluidState, mesh: Mesh, step: Step, impulses: FloatArray) -> Response:
        """Impulse response: the twists that each of c ``impulses`` (c, n, d+k) on the free bodies gives in this
        ``step`` [force·time | force·length·time]; asked of backends with a mesh alone."""

    @abstractmethod
    @gives(backends.state_and_energy)
    def transfer(self, fluid: FluidState, old: Mesh, new: Mesh) -> tuple[FluidState, float]:
        """The state on another mesh of the same domain at the same time, and the kinetic energy lost [energy]."""

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

    @abstractmethod
    @gives(backends.probes)
    def probe(self, fluid: FluidState, mesh: Mesh, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Velocity (N, d) and pressure (N,) at ``points`` (N, d); outside the mesh the nearest cell's values."""

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
