"""Do gravity and densities belong to the same units, and how far does a body go?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigidfluid.checks.finding import Finding, figure
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.system import System
from rigidfluid.core.setup.model import Model

QUESTION = "units"

_LIGHT, _HEAVY = (0.1, 30.0), (100.0, 30000.0)
_MIXED = (
    ("g/cm³", _LIGHT, "m/s²", 9.81, 981.0),
    ("kg/m³", _HEAVY, "cm/s²", 981.0, 9.81),
    ("g/cm³", _LIGHT, "mm/s²", 9810.0, 981.0),
    ("kg/m³", _HEAVY, "mm/s²", 9810.0, 9.81),
)
"""Densities of liquids and solids in a unit, the Earth's gravity in another system's, and in that of the densities."""


def unit_findings(model: Model, system: System) -> Iterator[Finding]:
    """Tell speed, Reynolds and Bingham number and way of the fastest body, with the viscosity of the shear rate
    v/d; a warning where gravity is the Earth's in another unit than densities of liquids and solids are in."""
    speeds, fluid = system.loads.travel_speed, system.fluid
    if fluid is None or speeds is None or not np.any(speeds > 0.0):
        return
    fastest = int(np.argmax(speeds))
    name, speed = system.surfaces[fastest], float(speeds[fastest])
    diameter = 2.0 * equal_volume_radius(system.bodies[fastest])
    viscosity = float(fluid.material.viscosity(np.array([speed / diameter]))[0])
    reynolds = speed * diameter * fluid.density / viscosity
    found: dict[str, float] = {"speed": speed, "reynolds": reynolds, "diameters": speed * model.time.end / diameter}
    text = f"{name} may reach a speed of {figure(speed)} and a Reynolds number of {figure(reynolds)}, and go"
    text += f" {figure(speed * model.time.end / diameter)} diameters until time.end"
    if isinstance(fluid.material, GeneralisedNewtonian):
        found["viscosity"] = viscosity
        text += f", at the viscosity {figure(viscosity)} of the shear rate {figure(speed / diameter)}"
        if (yield_stress := fluid.material.yield_stress) is not None:
            found["bingham"] = yield_stress * diameter / (fluid.material.dynamic_viscosity * speed)
            text += f"; its Bingham number is {figure(found['bingham'])}"
    densities = [fluid.density, *(body.density for body in model.bodies)]
    vector = np.zeros(model.dimension) if model.gravity is None else np.asarray(model.gravity, dtype=float)
    gravity = float(np.linalg.norm(vector))
    in_mm = model.units is not None and (model.units.length, model.units.mass) == ("mm", "mg")  # 1 mg/mm³ is 1 g/cm³
    for unit, (least, most), other, earth, meant in () if in_mm else _MIXED:
        if abs(gravity / earth - 1.0) < 0.01 and all(least <= density <= most for density in densities):
            text += f"; gravity is the Earth's in {other}, and densities are as in {unit}"
            asked = ", ".join(f"{part * meant / gravity + 0.0:.6g}" for part in vector)
            remedy = f"Set gravity = [{asked}] in [fluid], or ignore this if it is intended."
            yield Finding("warning", QUESTION, (name,), text, remedy, found)
            return
    yield Finding("note", QUESTION, (name,), text, found=found)
