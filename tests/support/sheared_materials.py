"""Generalised Newtonian fluids in flows that a formula and one integral give: along a channel, between cylinders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from curved_channels import INNER, OUTER, bend
from scipy.optimize import brentq

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.fluid.conditions import NoSlip, Periodic, no_pressure
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.types import Pose
from rigidfluid.materials.bingham import Bingham, BinghamOptions
from rigidfluid.materials.carreau import Carreau, CarreauOptions
from rigidfluid.materials.cross import Cross, CrossOptions
from rigidfluid.materials.herschel_bulkley import HerschelBulkley, HerschelBulkleyOptions
from rigidfluid.materials.power_law import PowerLaw, PowerLawOptions
from rigidfluid.testing.fluid.boxes import box, nobody
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import Bodies, Flow

DROP = 2.0
"""Pressure drop over the length 1 of a channel of width 1: shear stresses are up to half of it."""

TURN = 3.0
"""Angular velocity of the inner cylinder [1/time]."""

_ROOTS, _WEIGHTS = np.polynomial.legendre.leggauss(8)


def materials(dimension: int) -> dict[str, GeneralisedNewtonian]:
    """One of each kind, all far from Newtonian at the shear rates of the channel."""
    thickening = PowerLawOptions(viscosity=0.3, shear_rate=1.0, exponent=1.4, least_shear_rate=0.1)
    return {
        "carreau": Carreau(
            CarreauOptions(viscosity=0.5, viscosity_infinite=0.02, relaxation_time=2.0, exponent=0.4), dimension
        ),
        "cross": Cross(
            CrossOptions(viscosity=0.5, viscosity_infinite=0.05, relaxation_time=1.0, exponent=0.8), dimension
        ),
        "power_law": PowerLaw(
            PowerLawOptions(viscosity=0.3, shear_rate=1.0, exponent=0.5, least_shear_rate=0.2), dimension
        ),
        "thickening": PowerLaw(thickening, dimension),
        "bingham": Bingham(BinghamOptions(viscosity=0.1, yield_stress=0.3, stress_growth=5.0), dimension),
        "herschel_bulkley": HerschelBulkley(
            HerschelBulkleyOptions(viscosity=0.15, shear_rate=1.0, exponent=0.7, yield_stress=0.2, stress_growth=5.0),
            dimension,
        ),
    }


def shear_rate_at(material: GeneralisedNewtonian, stress: float) -> float:
    """γ̇ with μ(γ̇) γ̇ = ``stress`` [1/time]."""

    def excess(rate: float) -> float:
        return float(material.viscosity(np.array([rate]))[0]) * rate - stress

    return float(brentq(excess, 0.0, 1e6, xtol=1e-14, rtol=1e-14)) if stress > 0.0 else 0.0


def channel_speed(material: GeneralisedNewtonian, height: float, panels: int = 12) -> float:
    """u(y) = ∫₀^y γ̇(G |½ - s|) ds, the steady flow along a channel."""
    to_wall = min(height, 1.0 - height)
    edges = np.linspace(0.0, to_wall, panels + 1)
    found = 0.0
    for low, high in pairwise(edges):
        at = 0.5 * (low + high) + 0.5 * (high - low) * _ROOTS
        rates = [shear_rate_at(material, DROP * (0.5 - s)) for s in at]
        found += 0.5 * (high - low) * float(_WEIGHTS @ rates)
    return found


def channel_flow(
    material: Any, divisions: int, dimension: int = 2, tolerance: float = 1e-11, inertia: bool = False
) -> Flow:
    """Fluid at rest in a periodic channel along x, with walls across y."""
    posed = replace(problem(dimension, inertia=inertia), material=material)
    conditions = list(posed.conditions)
    for axis in (0, 2)[: dimension - 1]:
        first, second = conditions[2 * axis], conditions[2 * axis + 1]
        jump = (lambda _, at: np.full(len(at), DROP)) if axis == 0 else no_pressure
        conditions[2 * axis] = Periodic(first.surface, first.name, first.normal, second.surface, jump)
        conditions[2 * axis + 1] = Periodic(second.surface, second.name, second.normal)
    posed = replace(posed, conditions=tuple(conditions))
    backend = ScikitFem(ScikitFem.Options(tolerance=tolerance), posed)
    return Flow.start(backend, box(dimension, divisions), nobody(dimension))


def turning_flow(material: Any, layers: int) -> Flow:
    """Steady Stokes flow around a disk that turns with `TURN` in a round wall at rest, on curved cells."""
    return moved_flow(material, layers, [0.0, 0.0, TURN])


def moved_flow(material: Any, layers: int, twist: Sequence[float], engine: type[Any] = ScikitFem) -> Flow:
    """The same around a disk that moves with a ``twist`` (3,) in the middle, by a backend, the ``engine``."""
    posed = FluidProblem(2, 1, 1.0, material, False, (NoSlip(1, "outer", None),))
    pose = Pose(np.zeros((1, 2)), np.zeros((1, 1)))
    backend = engine(engine.Options(tolerance=1e-11), posed)
    start = Flow.start(backend, bend(layers, None), pose, Bodies.uniform(pose))
    return start.after(None, twist=np.array([twist]))


def turning_torque(material: GeneralisedNewtonian) -> float:
    """T with ∫ γ̇(T/(2π r²))/r dr = Ω from the inner to the outer radius."""
    at = 0.5 * (INNER + OUTER) + 0.5 * (OUTER - INNER) * np.polynomial.legendre.leggauss(40)[0]
    weight = 0.5 * (OUTER - INNER) * np.polynomial.legendre.leggauss(40)[1]

    def excess(torque: float) -> float:
        rates = [shear_rate_at(material, torque / (2.0 * np.pi * r**2)) / r for r in at]
        return float(weight @ rates) - TURN

    return float(brentq(excess, 1e-6, 30.0, xtol=1e-12, rtol=1e-12))
