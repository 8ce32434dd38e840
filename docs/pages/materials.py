"""Fluids whose viscosity varies: orders of convergence, bounds of drags, and the plastic limit of a cylinder's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from crossing_disk import bounds_of_drag, drag_in_power_law, newtonian_drag, slope_of_drag
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.tri import Triangulation
from page_tools import Page, Work, table
from sheared_materials import channel_flow, channel_speed, materials, turning_flow, turning_torque

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.cell_gradients import velocity_gradients

DIVISIONS, LAYERS, BINGHAM = (8, 16, 32), (4, 8, 16), (3, 10, 30, 100)
GROWTH, LIMIT = 100.0, 4.0 * np.sqrt(2.0) + 2.0 * np.pi
EXPONENTS, THINNING = (0.3, 0.5, 0.7, 0.9, 1.0, 1.2, 1.4), (0.4, 0.2, 0.1, 0.05)
STEP, SIDE, WIDE = 0.01, 5.0, 10.0
MESHES = [{"size": 0.25, "size_body": edge, "growth": edge / 0.6} for edge in (0.12, 0.06, 0.03)]
COARSE, FINE = MESHES[1:]


@dataclass(frozen=True)
class Cylinder:
    """Steady flow around a cylinder of diameter 1 and velocity 1 in a fluid with the yield stress 1: its ``drag``, and
    the ``stress`` in those cells where the fluid yields, a ``triangulation``."""

    drag: float
    triangulation: Triangulation
    stress: FloatArray


def page(work: Work) -> Page:
    """Errors in channels and between cylinders, and drags."""
    names = list(materials(2))
    channels = {name: [channel_error(name, divisions) for divisions in DIVISIONS] for name in names}
    torques = {name: [torque_error(name, layers) for layers in LAYERS] for name in names}
    cylinders = {number: cylinder(bingham(number), FINE) for number in BINGHAM}
    thin = {exponent: cylinder(power_law(exponent), FINE).drag for exponent in THINNING}
    text = ABOUT + _orders("divisions", DIVISIONS, channels) + TORQUES + _orders("layers", LAYERS, torques)
    text += CROSSING.format(slope=_slope(), exact=slope_of_drag(), drag=newtonian_drag()) + _crossings()
    text += DRAG.format(limit=LIMIT, wide=cylinder(bingham(10), COARSE, WIDE).drag)
    text += _above("Bingham number", {number: cylinders[number].drag for number in BINGHAM}, BINGHAM[1:])
    text += POWER_LAW + _above("n", thin, THINNING) + HALVED
    text += table(("fluid", *(f"edges of {mesh['size_body']} d" for mesh in MESHES), "changes"), [
        _halvings("Bingham number 10", bingham(10), cylinders[10].drag), _halvings("n = 0.1", power_law(0.1), thin[0.1])
    ])  # fmt: skip
    return Page("Fluids whose viscosity varies", text, {"": plot(cylinders)})


def channel_error(name: str, divisions: int) -> float:
    """Root mean square error of the velocity along a channel, over that of the velocity."""
    material, points = materials(2)[name], np.random.default_rng(0).uniform(size=(200, 2))
    velocity, _ = channel_flow(material, divisions).after(None).probe(points)
    exact = np.array([[channel_speed(material, y), 0.0] for y in points[:, 1]])
    return float(np.linalg.norm(velocity - exact) / np.linalg.norm(exact))


def torque_error(name: str, layers: int) -> float:
    """Relative error of the torque on a disk that turns in a round wall."""
    material = materials(2)[name]
    torque = turning_flow(material, layers).advance.hydrodynamic_wrench.torque[0, 0]
    return float(abs(torque / -turning_torque(material) - 1.0))


def bingham(number: float) -> dict[str, Any]:
    """A Bingham fluid with the yield stress 1, of that Bingham ``number`` at a diameter and a velocity of 1."""
    return {"type": "bingham", "viscosity": 1.0 / number, "yield_stress": 1.0, "stress_growth": GROWTH}


def power_law(exponent: float) -> dict[str, Any]:
    """τ = γ̇ⁿ of that ``exponent`` n."""
    return {"type": "power_law", "viscosity": 1.0, "shear_rate": 1.0, "exponent": exponent, "least_shear_rate": 1e-2}


def cylinder(material: dict[str, Any], mesh: dict[str, float], side: float = SIDE) -> Cylinder:
    """One step of Stokes flow from rest, which is steady, in a square box of that ``side``."""
    moving = {"position": [0.0, 0.0], "prescribed": {"velocity": [1.0, 0.0]}}
    scene = {
        "scene": {"name": "cylinder", "dimension": 2},
        "fluid": {"model": "stokes", "density": 1.0, "material": material},
        "domain": {"lower": [-0.5 * side] * 2, "upper": [0.5 * side] * 2},
        "body": [{"type": "sphere", "radius": 0.5, "density": 1.0} | moving],
        "mesh": mesh,
        "time": {"end": 1e-6, "step": 1e-6},
        "output": {"every": 1e-6},
    }
    it = Simulation(scene_from_dict(scene))
    it.step()
    fields = it.fields()
    slopes = velocity_gradients(fields)[:, :3].mean(axis=1)
    rate = np.sqrt(0.5 * np.sum((slopes + np.swapaxes(slopes, 1, 2)) ** 2, axis=(1, 2)))
    stress = it.system.fluid.material.viscosity(rate) * rate
    yields = stress >= 1.0
    triangulation = Triangulation(*fields.points.T, fields.cells[yields, :3])
    return Cylinder(-float(it.bodies["body0"].force[0]), triangulation, stress[yields])


def plot(cylinders: Mapping[int, Cylinder]) -> Figure:
    """Stress over the yield stress around the cylinders; white where the fluid does not yield."""
    figure = Figure(figsize=(9.0, 2.8), dpi=120, layout="constrained")
    every = figure.subplots(1, len(cylinders), sharey=True)
    for axes, (number, found) in zip(every, cylinders.items(), strict=True):
        image = axes.tripcolor(found.triangulation, found.stress, cmap="viridis", vmin=1.0, vmax=2.0)
        axes.add_patch(Circle((0.0, 0.0), 0.5, color="grey"))
        axes.set(aspect="equal", title=f"Bingham number {number}", xlim=(-2.5, 2.5), ylim=(-2.5, 2.5))
    figure.colorbar(image, ax=every, label="stress / yield stress", extend="max")
    return figure


def _slope() -> float:
    """d drag/dn at n = 1 by a central difference, on the finest layers."""
    ahead, behind = (drag_in_power_law(1.0 + step, LAYERS[-1]) for step in (STEP, -STEP))
    return (ahead - behind) / (2.0 * STEP)


def _crossings() -> str:
    """Table of drags on a disk in a round wall, between their bounds."""
    rows = []
    for exponent in EXPONENTS:
        below, above = bounds_of_drag(exponent)
        drags = [drag_in_power_law(exponent, layers) for layers in LAYERS]
        rows.append((f"{exponent}", *(f"{each:.2f}" for each in (below, *drags, above)), _order(drags)))
    return table(("n", "bound below", *(f"{layers} layers" for layers in LAYERS), "bound above", "order"), rows)


def _above(first: str, drags: Mapping[float, float], fitted: Sequence[float]) -> str:
    """Table of drags above the plastic limit, and the power by which those that are ``fitted`` go to it."""
    rows = [(f"{value}", f"{drag:.2f}", f"{drag / LIMIT - 1.0:.1%}") for value, drag in drags.items()]
    power, factor = np.polyfit(np.log(fitted), np.log([drags[value] - LIMIT for value in fitted]), 1)
    goes = f"Above the limit it goes as {np.exp(factor):.1f} τ d times {first} to the power {power:.2f}"
    return table((first, "drag / τ d", "above the limit"), rows) + f"\n\n{goes}, a fit to the last {len(fitted)}.\n"


def _halvings(name: str, material: dict[str, Any], finest: float) -> tuple[str, ...]:
    """Row of drags with halved edges up to the ``finest``, and by how much each halving changes them."""
    drags = [*(cylinder(material, mesh).drag for mesh in MESHES[:-1]), finest]
    changes = " and ".join(f"{ratio - 1.0:+.2%}" for ratio in np.divide(drags[1:], drags[:-1]))
    return (name, *(f"{drag:.3f}" for drag in drags), changes)


def _order(found: Sequence[float]) -> str:
    """Order of convergence of three values, each with half the edges of the one before."""
    return f"{np.log2(abs((found[1] - found[0]) / (found[2] - found[1]))):.1f}"


def _orders(first: str, counts: Sequence[int], columns: Mapping[str, Sequence[float]]) -> str:
    """Table of errors, each with the order of convergence since the one before."""
    rows = [(str(count), *(_error(errors, i) for errors in columns.values())) for i, count in enumerate(counts)]
    return table((first, *columns), rows)


def _error(errors: Sequence[float], i: int) -> str:
    """Error of number ``i``, and the order of convergence by the last halving before it."""
    return f"{errors[i]:.1e}" + (f" ({np.log2(errors[i - 1] / errors[i]):.1f})" if i else "")


ABOUT = """Stokes flow in 2D of fluids whose [viscosity varies](../howto/shear-thinning.md), against flows that follow
from one integral of the shear rate that belongs to a stress. In brackets the order of convergence.

## Along a channel

A periodic channel of width 1 with a pressure drop of 2 over its width, cut into so many squares, each of two triangles;
error of the velocity (root mean square over its own). The shear rate vanishes half-way between the walls. `thickening`,
a power law with n = 1.4, has its least viscosity there, in a layer that is no thicker than cells of the finest mesh.

"""

TORQUES = """

## Between cylinders

A disk of radius 0.5 turns with an angular velocity of 3 in a round wall of radius 1; cells are curved along both. Error
of the torque on the disk.

"""

CROSSING = """

## A disk across a round wall

The same disk moves across the middle of the wall with the velocity 1 in a power-law fluid, τ = γ̇ⁿ. Its drag is between
two bounds, by the extremum principles of Hill and Power (Q. J. Mech. Appl. Math. 9, 313, 1956,
doi:10.1093/qjmam/9.3.313) with the velocity and the stress of the Newtonian flow, which has a closed form. At n = 1
they meet at {drag:.4f}, where the drag's derivative by n is {slope:.3f}, and {exact:.3f} by the reciprocal theorem.
`order`: of convergence, from the differences of the three.

"""

DRAG = """

## A cylinder in a Bingham fluid

A cylinder moves slowly through a Bingham fluid in a box of side 5 diameters. At high Bingham numbers τ_y d/(μ v) its
drag is that in a plastic solid, (4√2 + 2π) τ_y d = {limit:.2f} τ_y d for a surface that the solid sticks to: exact
(Randolph and Houlsby, The limiting pressure on a circular pile loaded laterally in cohesive soil, Géotechnique 34, 613,
1984, doi:10.1680/geot.1984.34.4.613). Papanastasiou's m is 100 d/v, and edges on the cylinder are 0.03 d long. In a
box of side 10, with edges of 0.06 d, the drag at a Bingham number of 10 is {wide:.2f}.

The fluid is white in the picture where it does not yield.

"""

POWER_LAW = """
## A cylinder in a power-law fluid

In the same box. A fluid with the stress τ = K γ̇ⁿ becomes a plastic solid with the yield stress K as n goes to 0, so
its drag goes to the same limit. It is over K (v/d)ⁿ d here; the fluid is Newtonian below shear rates of 0.01 v/d.

"""

HALVED = """
Drags over τ d on meshes of halved edges, with τ = τ_y or K (v/d)ⁿ:

"""
