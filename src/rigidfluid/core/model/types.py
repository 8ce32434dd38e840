"""The data that travels through the loop: frozen records of arrays.

Shapes: ``n`` bodies, ``d`` space dimensions, ``k`` rotational degrees of freedom (1 in 2D, 3 in 3D),
``m`` contacts, ``q`` components of an orientation (1, an angle, in 2D; 4, a scalar-first unit quaternion, in 3D).
Surfaces are numbered through: bodies 0 … n-1, then the pieces of the domain's boundary n, n+1, …
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.fluid.material import Material as Material
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.model.boundary_forces import BoundaryForces
from rigidfluid.core.model.kinematics import EACH_ITS_OWN, Kinematics
from rigidfluid.core.model.ranks import ALONE, Ranks
from rigidfluid.core.model.scalar_account import ScalarAccount

if TYPE_CHECKING:
    from rigidfluid.core.model.force_law import ForceLaw

_FROM_RADII: FloatArray = np.empty(0)
"""Placeholder for effective radii that are not given, and follow from the radii of curvature."""

_NO_TURNING: FloatArray = np.empty(0)
"""Placeholder for relative angular velocities that are not given, and are zero."""

_POSITIVE: FloatArray = np.empty(0)
"""Placeholder for signs that are not given."""

FluidState = Mapping[str, FloatArray]
"""State of a fluid backend between steps, as named arrays, so that a checkpoint can hold it unchanged."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Pose of the bodies: ``position`` (n, d) [length], ``orientation`` (n, q) [rad | 1]."""

    position: FloatArray
    orientation: FloatArray


@dataclass(frozen=True, slots=True)
class Twist:
    """Twist of the bodies: ``velocity`` (n, d) [length/time], ``angular_velocity`` (n, k) [rad/time]."""

    velocity: FloatArray
    angular_velocity: FloatArray


@dataclass(frozen=True, slots=True)
class Wrench:
    """Wrench on the bodies: ``force`` (n, d) [force], ``torque`` (n, k) about the centre of mass [force·length]."""

    force: FloatArray
    torque: FloatArray


@dataclass(frozen=True, slots=True)
class Contacts:
    """Pairs of surfaces near each other; ``normal`` points from b to a, so ``point_a = point_b + gap * normal``.

    ``body_a`` (m,) is always a body, ``body_b`` (m,) a body or a wall (its surface number);
    ``point_a``, ``point_b``, ``normal`` (m, d); ``gap`` (m,) [length], negative where they overlap;
    ``radius_a``, ``radius_b`` (m,) radii of curvature [length], infinite on a flat wall, negative on a hollow one, NaN
    where not known; ``at_wall`` (m,): whether b is a wall. ``effective_radius`` (m,): of the ball at a flat wall that
    squeezes a thin film alike, from the radii if not given, NaN where not known [length]. ``sign`` (m,): 1, which is
    taken if it is not given, or -1 of a contact whose energy and forces are taken away, as others count them twice.
    ``shift`` (m, d): displacement of b's image that is met from b itself, between periodic surfaces; None if there are
    none, so that all are zero [length]. Points and normals are those of a and of that image. ``curvatures`` (m, 2, d,
    d): curvature tensors of a and of b, zero along the normal, NaN where not known [1/length]; None unless a law asks
    for them.
    """

    body_a: IntArray
    body_b: IntArray
    point_a: FloatArray
    point_b: FloatArray
    normal: FloatArray
    gap: FloatArray
    radius_a: FloatArray
    radius_b: FloatArray
    at_wall: BoolArray
    effective_radius: FloatArray = field(default_factory=lambda: _FROM_RADII)
    sign: FloatArray = field(default_factory=lambda: _POSITIVE)
    shift: FloatArray | None = None
    curvatures: FloatArray | None = None

    def __post_init__(self) -> None:
        if self.sign is _POSITIVE:
            object.__setattr__(self, "sign", np.ones(len(self.gap)))
        if self.effective_radius is _FROM_RADII:
            with np.errstate(divide="ignore"):  # a ball that fills its hollow
                radius = 1.0 / (1.0 / self.radius_a + 1.0 / self.radius_b)
            object.__setattr__(self, "effective_radius", radius)

    def __len__(self) -> int:
        return len(self.gap)


@dataclass(frozen=True, slots=True)
class Motion:
    """Relative motion of the surfaces of each contact, for forces that depend on it.

    ``velocity`` (m, d) of a relative to b, both as rigid bodies, half-way between the contact points [length/time];
    ``mass`` (m,) effective, m_a m_b/(m_a + m_b), and m_a at a wall [mass]; ``angular_velocity`` (m, k) of a relative to
    b, zero if not given, as for laws that give no couples [rad/time].
    """

    velocity: FloatArray
    mass: FloatArray
    angular_velocity: FloatArray = field(default_factory=lambda: _NO_TURNING)

    def __post_init__(self) -> None:
        if self.angular_velocity is _NO_TURNING:
            count, dimension = self.velocity.shape
            object.__setattr__(self, "angular_velocity", np.zeros((count, 1 if dimension == 2 else 3)))

    def select(self, chosen: IntArray | BoolArray) -> Motion:
        """Motion in the contacts ``chosen``, (k,) numbers in the order wanted or (m,) truth values."""
        return Motion(self.velocity[chosen], self.mass[chosen], self.angular_velocity[chosen])


@dataclass(frozen=True, slots=True)
class Film:
    """The fluid between bodies near contact: its ``material``, and whether it has ``inertia``; ``radius`` (n,) of the
    balls of equal volume [length]; ``finest_cell`` of the mesh, which resolves the film, infinite where it resolves
    none [length]."""

    material: Material
    radius: FloatArray
    finest_cell: float
    inertia: bool


@dataclass(frozen=True, slots=True)
class Loads:
    """Loads that the contacts must hold: ``smallest_gap`` [length] is wanted where a body hits head-on.

    Each body has ``mass`` (n,), infinite where its twist is given [mass]; ``weight`` (n,), the magnitude of the
    submerged weight [force]; ``speed`` (n,), expected at the impact [length/time]. ``stacked_weight`` (n,) [force] and
    ``stacked_energy`` (n,), ½ m v² [energy], are those of the body and of all that may come to press on it, infinite
    where its twist is given. ``film``: that which brakes them before, None without a fluid. In a fluid ``travel_speed``
    (n,) is the highest expected between body and fluid, and ``flow_speed`` that of the fluid as it is given on the
    boundary and at the start [length/time]. ``attraction``: all laws that attract, whose work contacts must hold too.
    ``names`` of the bodies are for messages.
    """

    mass: FloatArray
    weight: FloatArray
    speed: FloatArray
    stacked_weight: FloatArray
    stacked_energy: FloatArray
    smallest_gap: float
    film: Film | None = None
    travel_speed: FloatArray | None = None
    flow_speed: float = 0.0
    attraction: ForceLaw | None = None
    names: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class MeshPart:
    """Part of a mesh that one process holds, and its numbers in the whole.

    A part has cells of its own and all their vertices; those on a border are in several parts, and ``owned`` (N,) by
    the one of lowest rank. ``vertices`` (N,), ``cells`` (M,), ``facets`` (F,): numbers in the whole mesh; ``counts``
    (3,): how many vertices, cells and facets that has. ``ranks``: the processes that hold the parts.
    """

    ranks: Ranks
    vertices: IntArray
    cells: IntArray
    facets: IntArray
    owned: BoolArray
    counts: IntArray


@dataclass(frozen=True, slots=True)
class CurvedEdges:
    """The edges of quadratic cells that are not straight: their ``vertices`` (K, 2), the ``surface`` (K,) that each
    lies on, and the ``middles`` (K, d) that they pass through half-way [length]."""

    vertices: IntArray
    surface: IntArray
    middles: FloatArray


@dataclass(frozen=True, slots=True)
class Periods:
    """Periods of a mesh with periodic surfaces: ``ways`` (k, d) from what is on the mesh to its next images [length],
    and the ``winding`` (n, k): by how many of each way a body's pose is ahead of its image on the mesh."""

    ways: FloatArray
    winding: IntArray


@dataclass(frozen=True, slots=True)
class Mesh:
    """Simplices: ``points`` (N, d) [length], ``cells`` (M, d+1), boundary ``facets`` (F, d) and ``markers`` (F,), the
    number of the surface that each facet lies on. All edges are straight but those ``curved``. ``part`` is None where
    it is the whole mesh, ``periods`` where no surfaces are periodic."""

    points: FloatArray
    cells: IntArray
    facets: IntArray
    markers: IntArray
    part: MeshPart | None = None
    curved: CurvedEdges | None = None
    periods: Periods | None = None

    @staticmethod
    def empty(dimension: int) -> Mesh:
        """A mesh without cells: that of a scene without a fluid."""
        none = np.zeros((0, dimension), dtype=np.int64)
        return Mesh(np.zeros((0, dimension)), np.zeros((0, dimension + 1), dtype=np.int64), none, none[:, 0])

    @property
    def ranks(self) -> Ranks:
        """The processes that hold the whole mesh together."""
        return ALONE if self.part is None else self.part.ranks

    @property
    def geometry(self) -> FloatArray:
        """All that says where the mesh is: the vertices, then the middles of curved edges, (N + K, d) [length]."""
        return self.points if self.curved is None else np.concatenate([self.points, self.curved.middles])

    def images_of(self, pose: Pose) -> Pose:
        """Pose of the bodies' images that are on this mesh, with the bodies themselves at ``pose``."""
        if self.periods is None:
            return pose
        return Pose(pose.position - self.periods.winding @ self.periods.ways, pose.orientation)

    def moved_to(self, geometry: FloatArray) -> Mesh:
        """The same cells elsewhere, at a ``geometry`` (N + K, d) [length]."""
        if self.curved is None:
            return replace(self, points=geometry)
        points, middles = geometry[: len(self.points)], geometry[len(self.points) :]
        return replace(self, points=points, curved=replace(self.curved, middles=middles))


@dataclass(frozen=True, slots=True)
class Links:
    """Constraints and dampers of N motions at one moment: C u + compliance · force = rate for their twists u, and Cᵀ
    force acts on them.

    ``rows`` (c, N, d+k): C, zero for motions of prescribed twist; ``rate`` (c,): at which a link is driven, less what
    prescribed motion has of it [length/time | rad/time]; ``compliance`` (c,): 1/c of a damper, 0 where a link is rigid
    [length/(force·time) | rad/(force·length·time)]. The links' power on the motions is force · rate less compliance ·
    force².
    """

    rows: FloatArray
    rate: FloatArray
    compliance: FloatArray


NO_LINKS = Links(np.zeros((0, 0, 0)), np.zeros(0), np.zeros(0))
"""Nothing that holds motions."""


@dataclass(frozen=True, slots=True)
class Step:
    """All that a backend needs to go one step on; the time scheme is in the weights, not in the backend.

    ``derivative`` (3,) [1/time]: ∂u/∂t ≈ d₀uⁿ⁺¹ + d₁uⁿ + d₂uⁿ⁻¹, all zero for a steady flow. ``extrapolation`` (2,):
    uⁿ⁺¹ ≈ e₀uⁿ + e₁uⁿ⁻¹.
    ``pose``: of the bodies, there. ``points`` (N + K, d): the mesh's geometry at the new time; None for responses
    on the present one.
    Newton–Euler of the bodies: ``mass_matrix`` (n, d+k, d+k) times the new twist = ``load`` (n, d+k) + the fluid's
    wrench, where ``prescribed`` (n,) is False; elsewhere the twist is ``prescribed_twist`` (n, d+k).
    All these are of the N motions that carry the bodies, by ``kinematics``, and the fluid's wrench on them is Gᵀ of
    that on the bodies.
    In ``load`` is d₀ times ``impulse`` (n, d+k), which the contacts of this step gave at once
    [force·time | force·length·time]; ``load_scale`` is the size of the parts of the load, which may cancel each other.
    ``turning`` (n, d+k): impulses whose inviscid response is added to the convecting velocity,
    zero but for steps in which contacts turn bodies around [force·time | force·length·time].
    ``provisional``: the step will be solved again, along another path of the bodies, and five digits do.
    ``shared``: many bodies share right sides in the solve for its impulse responses, of which three digits do.
    ``links``: what else holds the motions at the new time. ``stresslets``: the bodies' stresslets are wanted;
    ``boundary_forces``: forces on the domain's boundary are; ``cell_errors``: errors of cells are.
    """

    time: float
    derivative: FloatArray
    extrapolation: FloatArray
    pose: Pose
    points: FloatArray | None
    mass_matrix: FloatArray
    load: FloatArray
    prescribed: BoolArray
    prescribed_twist: FloatArray
    impulse: FloatArray
    load_scale: float
    turning: FloatArray
    kinematics: Kinematics = EACH_ITS_OWN
    provisional: bool = False
    shared: bool = False
    links: Links = NO_LINKS
    stresslets: bool = False
    boundary_forces: bool = False
    cell_errors: bool = False


@dataclass(frozen=True, slots=True)
class SolverCost:
    """Expected cost of a run's steps.

    ``method``: of solution, as the scene's keys name it; ``unknowns`` of a step; ``memory`` of the process [byte]; CPU
    ``seconds`` that factors take, or what else preconditions, each time it is made, and ``step_seconds`` of a step far
    from contacts.
    """

    method: str
    unknowns: float
    memory: float
    seconds: float
    step_seconds: float


@dataclass(frozen=True, slots=True)
class Response:
    """Response of the twists of all bodies, or of the motions that carry them, to impulses on them, (c, n, d+k) each
    for c impulses.

    ``inviscid``: at once, with the masses of bodies and fluid and its incompressibility alone. ``viscous``: at the end
    of a step, by its own matrix, viscosity in it.
    """

    inviscid: FloatArray
    viscous: FloatArray


@dataclass(frozen=True, slots=True)
class Advance:
    """Result of a backend's step: its candidate state, the new twist, and the fluid's own figures.

    ``twist`` is what Newton–Euler's equations are solved for: the motions'.
    ``hydrodynamic_wrench`` is the fluid's force and torque on each body alone, without buoyancy, weight or contact.
    ``dissipation`` by viscosity at the end, and ``dissipation_midway`` by the mean of the velocities at start and end
    [energy/time]. ``boundary_power`` is the mechanical power that enters through the domain's boundary [energy/time].
    ``link_force`` (c,): of the step's links [force | force·length]. ``spurious_flux``: kinetic energy that
    convection takes through faces that let none pass, an error of the mesh [energy/time]. ``grad_div``: what
    stabilisation takes, ∫ γ (∇·u)², numerical dissipation that is zero where cells resolve the flow [energy/time].
    ``source_power``: that of the problem's source on the fluid, ∫ f·u [energy/time].
    ``stress_power``: that of the end's viscous stress in the mean of the velocities at start and end, in a step without
    a past of a fluid with inertia; else None [energy/time].
    ``stresslet`` (n, d, d): symmetric first moment of the fluid's tractions on each body about its centre, ∮ ½ (a σ·n +
    σ·n a) with n into the fluid and its trace, for a pressure of zero mean in an enclosed flow; None where it is not
    wanted [force·length]. ``boundary_forces``: of the fluid on the domain's boundary, None where they are not wanted.
    ``scalar``: account of a transported scalar, None without one, and in provisional steps.
    ``cell_errors`` (M,): squared error of each cell by its residuals, in the norm of dissipation; None where it is not
    wanted [energy/time].
    """

    fluid: FluidState
    twist: Twist
    hydrodynamic_wrench: Wrench
    kinetic_energy: float
    dissipation: float
    dissipation_midway: float
    boundary_power: float
    link_force: FloatArray = field(default_factory=lambda: np.zeros(0))
    spurious_flux: float = 0.0
    grad_div: float = 0.0
    source_power: float = 0.0
    stress_power: float | None = None
    stresslet: FloatArray | None = None
    boundary_forces: BoundaryForces | None = None
    scalar: ScalarAccount | None = None
    cell_errors: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class Fields:
    """Nodal fields for output: ``points`` (N, d), quadratic ``cells`` (M, 6 | 10) in VTK's order, ``velocity`` (N, d),
    ``pressure`` (N,), a transported ``scalar`` (N,), if there is one, the ``viscosity`` (N,) where it varies, and
    ``cell_errors`` (M,) where they are estimated."""

    points: FloatArray
    cells: IntArray
    velocity: FloatArray
    pressure: FloatArray
    scalar: FloatArray | None = None
    viscosity: FloatArray | None = None
    cell_errors: FloatArray | None = None

    @property
    def nodal_values(self) -> dict[str, FloatArray]:
        """All that there is at the nodes, by name."""
        values = {one.name: getattr(self, one.name) for one in fields(Fields) if not one.name.startswith("cell")}
        return {name: value for name, value in values.items() if value is not None}

    def part(self, nodes: IntArray, cells: IntArray) -> Fields:
        """The values at some ``nodes`` (K,), and ``cells`` (L, b) between these."""
        return Fields(**{name: value[nodes] for name, value in self.nodal_values.items()}, cells=cells)


@dataclass(frozen=True)
class InsideFields:
    """The scalar inside bodies that conduct it: ``points`` (N, d), quadratic ``cells`` (M, 6 | 10) in VTK's order,
    ``scalar`` (N,), and the number of the ``body`` (N,) around each point."""

    points: FloatArray
    cells: IntArray
    scalar: FloatArray
    body: IntArray
