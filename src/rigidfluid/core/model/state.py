"""All that a run remembers between two steps."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.boundary_forces import BoundaryForces
from rigidfluid.core.model.energy import Ledger
from rigidfluid.core.model.flow_error import FlowError
from rigidfluid.core.model.reduced_model import Coupling
from rigidfluid.core.model.scalar_account import ScalarAccount
from rigidfluid.core.model.tangential_springs import TangentialSprings
from rigidfluid.core.model.types import Contacts, FluidState, Mesh, Pose, Twist, Wrench


@dataclass(frozen=True, slots=True)
class Reference:
    """The mesh that the last re-meshing made: the domain of the mesh map, with the ``pose`` and nearest ``gaps`` (n,)
    of the bodies there, its worst cell's ``quality``, and the ``tick`` when it was made."""

    mesh: Mesh
    pose: Pose
    gaps: FloatArray
    quality: float
    tick: int


@dataclass(frozen=True, slots=True)
class FailedRemesh:
    """A new mesh that could not be made at a ``tick``, and the ``reason``."""

    tick: int
    reason: str


@dataclass(frozen=True, slots=True)
class MotionState:
    """The N motions that carry the bodies, the bodies themselves where each moves by itself: their ``pose``, of the
    centres of mass, and ``twist``; ``contact``: the wrench of their contacts in a state, the impulse at the end of a
    path; ``hydrodynamic``: the fluid's wrench."""

    pose: Pose
    twist: Twist
    contact: Wrench
    hydrodynamic: Wrench


@dataclass(frozen=True, slots=True)
class LinkLoad:
    """Load of joints and springs on the motions in the latest step: the ``force`` (c,) of each link, and the ``wrench``
    (N, d+k) of all of them and of springs; at its end in a fluid, in the mean without one."""

    force: FloatArray
    wrench: FloatArray


def unloaded(motions: Pose) -> LinkLoad:
    """Load of no joints on motions at this pose."""
    count, d = motions.position.shape
    return LinkLoad(np.zeros(0), np.zeros((count, d + (1 if d == 2 else 3))))


@dataclass(frozen=True, slots=True)
class Prescription:
    """Velocities of the N motions that nothing can change, zero for those that are free or fixed: constant ``twist``
    (N, d+k), reached linearly from ``before`` (N, d+k) within ``over`` (N,) [time], and sinusoidal displacements of
    ``amplitude`` (N, d) and ``frequency`` (N,); each since its ``start`` (N,) [time], from its row of ``pose``."""

    twist: FloatArray
    before: FloatArray
    over: FloatArray
    amplitude: FloatArray
    frequency: FloatArray
    start: FloatArray
    pose: Pose


@dataclass(frozen=True, slots=True)
class ErrorEstimate:
    """Error of the latest step, relative [1]: its local ``error``, and the same ``with_contacts`` and their impacts;
    both infinite where nothing is known yet. ``steps``: how many were accepted since the motion began or was changed at
    once; ``level``: of the latest one without an impact. The greatest so far, or expected: ``speed`` of a free body
    [length/time], kinetic ``energy`` of all [energy]."""

    steps: int
    level: int
    error: float
    with_contacts: float
    speed: float
    energy: float

    @property
    def is_unknown(self) -> bool:
        """Tell whether there are too few steps yet."""
        return math.isinf(self.error)

    @property
    def restarted(self) -> ErrorEstimate:
        """Estimate after a change of the motion at once: unknown, over the same scales."""
        return replace(self, steps=0, error=math.inf, with_contacts=math.inf)


@dataclass(frozen=True, slots=True)
class Past:
    """Pose and twist of the motions one step earlier, for second order in time. ``applied``: the mean wrench from
    outside in the step since then, None without any."""

    pose: Pose
    twist: Twist
    step: float
    applied: Wrench | None = None


@dataclass(frozen=True, slots=True)
class State:
    """An accepted state.

    ``level`` is the latest step's, ``count`` the number of accepted steps, ``mesh`` where the mesh is now, without
    cells where there is no fluid. ``coupling``: of bodies near contacts with the fluid, on the present mesh, None where
    none are. The wrenches are those that led to the present twist. ``impact``: the tick at the end of the latest step
    in which an impact shorter than it stirred the fluid, None before the first. ``remesh_failed``: the latest time that
    this mesh could not be regenerated, None if it has not been tried. ``motions``: what carries the bodies, from which
    ``pose`` and ``twist`` are then evaluated. ``estimate``: of the latest step's error; None before the first step, and
    without a tolerance. ``link``: of joints.
    ``prescription``: what was prescribed since the start in the scene's place, None if nothing was. ``applied``: wrench
    from outside on the n bodies from now on, zero on those that are not free; None if nothing was applied yet.
    ``jumped``: the latest tick at which a prescribed velocity was changed by a jump, None before the first.
    ``springs``: those along the surfaces of contacts, None where there are none. ``stresslet`` (n, d, d): by the fluid
    [force·length], and ``boundary_forces``; None at the start, and where they are not wanted. ``scalar``: account of
    the transported scalar over the latest step; None at the start, and without one. ``cell_errors`` (M,): squared
    errors of the mesh's cells in the latest step [energy/time]; None on a new mesh, and where they are not wanted.
    ``flow_error``: at the latest outputs; None before the first, and without error bars.
    """

    tick: int
    count: int
    level: int | None
    pose: Pose
    twist: Twist
    past: Past | None
    mesh: Mesh
    reference: Reference
    fluid: FluidState
    coupling: Coupling | None
    contacts: Contacts
    gaps: FloatArray
    hydrodynamic_wrench: Wrench
    contact_wrench: Wrench
    motions: MotionState
    link: LinkLoad
    ledger: Ledger
    impact: int | None = None
    remesh_failed: FailedRemesh | None = None
    estimate: ErrorEstimate | None = None
    prescription: Prescription | None = None
    applied: Wrench | None = None
    jumped: int | None = None
    springs: TangentialSprings | None = None
    stresslet: FloatArray | None = None
    boundary_forces: BoundaryForces | None = None
    scalar: ScalarAccount | None = None
    cell_errors: FloatArray | None = None
    flow_error: FlowError | None = None

    @property
    def is_on_new_mesh(self) -> bool:
        """Tell whether its mesh was made for it."""
        return self.reference.tick == self.tick

    @property
    def past_twist(self) -> Twist | None:
        """Twist of the motions one step earlier, None at the start."""
        return None if self.past is None else self.past.twist

    @property
    def past_step(self) -> float | None:
        """Size of the latest step [time], None at the start."""
        return None if self.past is None else self.past.step
