"""Fluids whose viscosity varies: orders of convergence, and the plastic limit of a cylinder's drag."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
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
FINE = {"size": 0.25, "size_body": 0.03, "growth": 0.05}
COARSE = {"size": 0.25, "size_body": 0.06, "growth": 0.1}


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
    cylinders = {number: cylinder(number, FINE) for number in BINGHAM}
    drags = [cylinders[number].drag for number in BINGHAM]
    coarse = cylinder(10, COARSE).drag
    power, factor = np.polyfit(np.log(BINGHAM[1:]), np.log(np.subtract(drags[1:], LIMIT)), 1)
    rows = [
        (f"{number}", f"{drag:.2f}", f"{drag / LIMIT - 1.0:.1%}") for number, drag in zip(BINGHAM, drags, strict=True)
    ]
    text = ABOUT + _orders("divisions", DIVISIONS, channels) + TORQUES + _orders("layers", LAYERS, torques)
    text += DRAG.format(limit=LIMIT, fine=drags[1], coarse=coarse, power=power, factor=np.exp(factor))
    text += table(("Bingham number", "drag / τ_y d", "above the limit"), rows)
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


def cylinder(number: int, mesh: dict[str, float]) -> Cylinder:
    """One step of Stokes flow from rest, which is steady, at a Bingham ``number`` in a box of side 5."""
    material = {"type": "bingham", "viscosity": 1.0 / number, "yield_stress": 1.0, "stress_growth": GROWTH}
    moving = {"position": [0.0, 0.0], "prescribed": {"velocity": [1.0, 0.0]}}
    scene = {
        "scene": {"name": "cylinder", "dimension": 2},
        "fluid": {"model": "stokes", "density": 1.0, "material": material},
        "domain": {"lower": [-2.5, -2.5], "upper": [2.5, 2.5]},
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

DRAG = """

## A cylinder in a Bingham fluid

A cylinder moves slowly through a Bingham fluid in a box of side 5 diameters. At high Bingham numbers τ_y d/(μ v) its
drag is that in a plastic solid, (4√2 + 2π) τ_y d = {limit:.2f} τ_y d for a surface that the solid sticks to: exact
(Randolph and Houlsby, The limiting pressure on a circular pile loaded laterally in cohesive soil, Géotechnique 34, 613,
1984). Here the drag lies above that by {factor:.1f} Bi^{power:.2f} τ_y d, a power fitted from Bingham numbers of 10 on.
Papanastasiou's m is 100 d/v. Edges on the cylinder are 0.03 d long; with twice that the drag at a Bingham number of 10
is {coarse:.2f} instead of {fine:.2f}.

The fluid is white in the picture where it does not yield.

"""
