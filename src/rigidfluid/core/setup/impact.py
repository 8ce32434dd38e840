"""Speeds at which bodies are expected to hit: what gravity can give them on their way, and what the fluid lets them
keep."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.shapes import equal_volume_radius, inscribed_radius, shape_key
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.setup.boundary_samples import points_of, sample_times, sampled_inflows
from rigidfluid.core.setup.fluid import Fluid
from rigidfluid.errors import RigidfluidError

if TYPE_CHECKING:
    from rigidfluid.core.setup.model import Model
    from rigidfluid.core.setup.rigid_body import RigidBody

_HALVINGS = 60
_REYNOLDS = 1e-12, 1e12
_DOUBLINGS = 20
"""Most by which a viscosity that varies changes a speed, as often doubled or halved."""

_NEWTON_REYNOLDS, _NEWTON_DRAG = 1000.0, 0.44

Vectors = float | Sequence[float] | FloatArray | None


@dataclass(frozen=True)
class Impetus:
    """Causes of the speeds of bodies: their ``mass`` (n,) with the added mass and their ``weight`` (n, d) [force], each
    with what is linked to them, and the greatest speeds that strokes have ``given`` them, (n, 2) [length/time],
    [rad/time]."""

    mass: FloatArray
    weight: FloatArray
    given: FloatArray


def impact_speeds(model: Model, impetus: Impetus) -> FloatArray:
    """Speed at which each body is expected to hit something (n,) [length/time].

    v = √(v₀² + 2 (W/m) h), h the free height along the weight W to the end of the box around the domain, less the
    shortest range of a law, and m the mass. In a fluid at most the larger of v₀ and the terminal speed, and on top of
    that the fastest inflow. For v₀ the surface of a body that is no ball turns with it; v₀ of a component is at least
    the greatest speed that strokes give it. A prescribed body has the greatest speed of its prescription. An
    ``impact_speed`` that is given takes the place of all that for free bodies, but for v₀, which it cannot lower.
    """
    start, falling = _own_speeds(model, impetus)
    if model.wet:
        falling = falling + fastest_flow(model)
    if model.stepping.impact_speed is not None:
        falling = np.maximum(start, model.stepping.impact_speed)
    return np.where(model.prescribed, start, falling)


def travel_speeds(model: Model, impetus: Impetus) -> FloatArray:
    """Highest speed at which each body is expected to go through a fluid, or the fluid past it, (n,) [length/time].

    It is the larger of the body's own speed, estimated as in `impact_speeds`, and that of the fastest flow, whatever
    is said of impacts.
    """
    start, falling = _own_speeds(model, impetus)
    own = np.where(model.prescribed, start, falling)
    return np.maximum(own, fastest_flow(model))


def _own_speeds(model: Model, impetus: Impetus) -> tuple[FloatArray, FloatArray]:
    """v₀, and what it becomes by falling, each (n,) [length/time]."""
    lever = _measure_bodies(_lever, model.shapes)
    start = np.array([_own_speed(body, arm) for body, arm in zip(model.all_bodies, lever, strict=True)])
    start = np.maximum(start, impetus.given[:, 0] + lever * impetus.given[:, 1])
    weight = np.linalg.norm(impetus.weight, axis=1)
    falling = np.sqrt(start**2 + 2.0 * weight / impetus.mass * _free_heights(model, impetus.weight))
    if model.wet:
        falling = np.minimum(falling, np.maximum(start, terminal_speeds(model, weight)))
    return start, falling


def terminal_speeds(model: Model, weight: FloatArray) -> FloatArray:
    """Terminal speed (n,) [length/time] of each submerged weight ``weight`` (n,) [force], far from walls, from
    correlations for the drag of a ball of equal volume.

    3D: C = (24/Re)(1 + 0.15 Re^0.687) up to Re = 1000, then 0.44; 2D: C = 1 + 10 Re^(-2/3), with Re = 2 r ρ v/μ.
    Without inertia F = 6πμ r v in 3D and, since no such law exists in 2D for an unbounded fluid, 4πμ v/ln(L/r) with the
    longest side L of the box around the domain, less than the drag between its walls. The ball has nearly the least
    drag of all shapes of a volume, so that the speed errs to the fast side. A viscosity that varies is that of the
    shear rate v/2r.

    Schiller and Naumann, Z. Ver. Dtsch. Ing. 77 (1935) 318; White, Viscous Fluid Flow, McGraw-Hill 2006; Pironneau, J.
    Fluid Mech. 59 (1973) 117, doi:10.1017/S002211207300145X, for the shape of least drag.
    """
    assert isinstance(model.fluid, Fluid)
    material = model.fluid.material
    speeds = _terminal_speeds(model, weight, np.full(len(weight), material.dynamic_viscosity))
    if not isinstance(material, GeneralisedNewtonian):
        return speeds
    try:
        return _self_consistent_speeds(model, weight, material, speeds)
    except RigidfluidError:  # it has none at such a rate, which a run tells when it gets there
        return speeds


def _self_consistent_speeds(
    model: Model, weight: FloatArray, material: GeneralisedNewtonian, speeds: FloatArray
) -> FloatArray:
    """Terminal speeds v (n,) with the viscosity at the shear rate v/2r, by doubling or halving the ``speeds`` with one
    viscosity until they are passed, and bisection from there; unique where the stress grows with the shear rate."""
    rate = speeds / (2.0 * _measure_bodies(equal_volume_radius, model.shapes))
    factor, step = np.zeros(len(rate)), np.full(len(rate), np.log(2.0))
    passed, first = np.zeros(len(rate), dtype=bool), None
    for _ in range(_DOUBLINGS + _HALVINGS):
        times = np.exp(factor)
        faster = _terminal_speeds(model, weight, material.viscosity(times * rate)) > times * speeds
        first = faster if first is None else first
        passed |= faster != first
        step = np.where(passed, 0.5 * step, step)
        factor += np.where(faster, step, -step)
    return _terminal_speeds(model, weight, material.viscosity(np.exp(factor) * rate))


def _terminal_speeds(model: Model, weight: FloatArray, viscosity: FloatArray) -> FloatArray:
    """Terminal speed (n,) of each weight with a ``viscosity`` (n,) of its own."""
    fluid = model.fluid
    assert isinstance(fluid, Fluid)
    density, radius = fluid.density, _measure_bodies(equal_volume_radius, model.shapes)
    if not fluid.inertia:
        return np.asarray(weight / (viscosity * _resistances_per_viscosity(model)[:, 0]))
    per_weight, drag = (8.0 / np.pi, _ball_drag) if model.dimension == 3 else (4.0 * radius, _cylinder_drag)
    reynolds = _reynolds(weight * density / viscosity**2 * per_weight, drag)
    return np.asarray(reynolds * viscosity / (2.0 * radius * density))


def creeping_resistances(model: Model) -> FloatArray:
    """Resistance of a fluid without inertia to each velocity of each body (n, d+k) [force·time/length |
    force·length·time].

    It is that of a ball of equal volume far from walls, which nearly every shape and place exceeds: 6πμr and 8πμr³ in
    3D, 4πμr² for rotation in 2D and, for translation, 4πμ/ln(L/r) with the longest side L of the box around the domain.
    """
    assert isinstance(model.fluid, Fluid)
    return model.fluid.material.dynamic_viscosity * _resistances_per_viscosity(model)


def _resistances_per_viscosity(model: Model) -> FloatArray:
    """`creeping_resistances` at the viscosity 1 (n, d+k)."""
    d, radius = model.dimension, _measure_bodies(equal_volume_radius, model.shapes)[:, None]
    if d == 3:
        along, about = 6.0 * np.pi * radius, 8.0 * np.pi * radius**3
    else:
        along, about = 4.0 * np.pi / np.log(float(np.max(model.domain.size)) / radius), 4.0 * np.pi * radius**2
    spin = 1 if d == 2 else 3
    return np.hstack([np.repeat(along, d, axis=1), np.repeat(about, spin, axis=1)])


def _reynolds(driving: FloatArray, drag: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Re with C(Re) Re² = ``driving``, zero for no driving, by halving in the logarithm."""
    low, high = (np.full(len(driving), np.log(bound)) for bound in _REYNOLDS)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        reynolds = np.exp(middle)
        held = drag(reynolds) * reynolds**2 >= driving
        low, high = np.where(held, low, middle), np.where(held, middle, high)
    return np.where(driving > 0.0, np.exp(high), 0.0)


def _ball_drag(reynolds: FloatArray) -> FloatArray:
    slow = 24.0 / reynolds * (1.0 + 0.15 * reynolds**0.687)
    return np.where(reynolds < _NEWTON_REYNOLDS, slow, _NEWTON_DRAG)


def _cylinder_drag(reynolds: FloatArray) -> FloatArray:
    return np.asarray(1.0 + 10.0 * reynolds ** (-2.0 / 3.0))


def _free_heights(model: Model, weight: FloatArray) -> FloatArray:
    """Way along the weight from each body to the end of the box around the domain, less the range; zero without weight
    (n,)."""
    lower, upper = model.domain.extent
    length = np.linalg.norm(weight, axis=1, keepdims=True)
    down = np.divide(weight, length, out=np.zeros_like(weight), where=length > 0.0)
    position = np.array([body.position for body in model.all_bodies]).reshape(-1, model.dimension)
    ahead = np.where(down > 0.0, upper - position, position - lower)
    room = ahead - _measure_bodies(inscribed_radius, model.shapes)[:, None]
    way = np.divide(np.maximum(room, 0.0), np.abs(down), out=np.full_like(room, np.inf), where=down != 0.0)
    height = np.where(length[:, 0] > 0.0, way.min(axis=1), 0.0)
    shortest = min((law.range for law in model.laws), default=0.0)
    return np.maximum(height - shortest, 0.0)


def _own_speed(body: RigidBody, lever: float) -> float:
    """v₀ of a free body, or the greatest speed that its prescription gives to a prescribed one."""
    motion = body.prescribed or body
    speed = _length(motion.velocity) + lever * _length(motion.angular_velocity)
    if body.prescribed is None:
        return speed
    return speed + 2.0 * np.pi * (body.prescribed.frequency or 0.0) * _length(body.prescribed.amplitude)


def fastest_flow(model: Model) -> float:
    """Greatest speed prescribed on the boundary and at the start, at the points and times sampled [length/time]."""
    inflows = sampled_inflows(model.conditions, model.domain)
    pieces = zip(model.conditions, model.domain.pieces, strict=True)
    held = [(condition.held_flux, piece.area) for condition, piece in pieces if condition.held_flux is not None]
    steady = not held and all(inflow.velocity.is_steady for inflow in inflows)
    times = sample_times(model.conditions, model.time.end, steady=steady)
    sliding = [
        float(np.linalg.norm(wall.velocity(points_of(wall.shape, model.domain)), axis=1).max())
        for wall in model.walls
        if wall.velocity is not None
    ]
    inflowing = [inflow.speed(time) for inflow in inflows for time in times]
    passing = [abs(flux(float(time))) / area for flux, area in held for time in times]
    return max([model.fluid.fastest_at_start(model.domain), *sliding, *inflowing, *passing])


def _lever(body: Body) -> float:
    """The most that a normal passes the centre of mass, √(R² - r²); zero for a ball [length]."""
    return float(np.sqrt(max(body.bounding_radius**2 - inscribed_radius(body) ** 2, 0.0)))


def _length(vector: Vectors) -> float:
    return 0.0 if vector is None else float(np.linalg.norm(vector))


def _measure_bodies(measure: Callable[[Body], float], bodies: Sequence[Body]) -> FloatArray:
    """Measure each body (n,), one call for all bodies of one shape."""
    keys = [shape_key(body) for body in bodies]
    known = {key: measure(body) for key, body in dict(zip(keys, bodies, strict=True)).items()}
    return np.array([known[key] for key in keys])
