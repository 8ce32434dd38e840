"""Drops of pressure between periodic faces that drive given fluxes through them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Links
from rigidfluid.taylor_hood.elements.face import Face
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.system.coupled import CoupledSystem, Solution
from rigidfluid.taylor_hood.system.discretisation import Discretisation
from rigidfluid.taylor_hood.system.links import solve_linked


@dataclass(frozen=True, eq=False)
class Driven:
    """Solution of a step in which fluxes are held: the ``solution``, the ``link_force`` (c,) of `solve_linked`, and
    the ``load`` (nodes, d) of the drops of pressure on their faces."""

    solution: Solution
    link_force: FloatArray
    load: FloatArray


def solve_driven(
    discretisation: Discretisation, system: CoupledSystem, links: Links, time: float, tolerance: float
) -> Driven:
    """Solve for the drops of pressure with which each held flux at ``time`` is met to rounding.

    A step is linear: its solution with the drops expected, u, and the responses u_j to a unit drop each give
    the drops δ still missing, Σ_j Q_i(u_j) δ_j = Q_i - Q_i(u), and the solution u + Σ δ_j u_j. Joints and
    free bodies respond in each of these.

    Parameters
    ----------
    discretisation : Discretisation
        Solves with known drops.
    system : CoupledSystem
        The step's equations without these drops; its pressure tells the ones expected.
    links : Links
        Links between the motions.
    time : float
        End of the step [time].
    tolerance : float
        Relative residual of each solution [1].
    """
    surfaces, points = discretisation.surfaces, system.matrix.node_points
    first = surfaces.first_faces
    held = [number for number, face in enumerate(first) if face.condition.held_flux is not None]
    if not held:
        return Driven(*solve_linked(discretisation, system, links, tolerance), np.zeros_like(system.load))
    faces = [first[number] for number in held]
    wanted = np.array([face.condition.held_flux(time) for face in faces if face.condition.held_flux is not None])
    units = [_unit_drop(surfaces, face, points) for face in faces]
    expected = surfaces.pressure_drops(system.pressure)[held]
    load, jump = _combined(units, expected, system)
    driven = replace(system, load=system.load + load, pressure_jump=system.pressure_jump + jump)
    solution, force = solve_linked(discretisation, driven, links, tolerance)
    responses = [_response(discretisation, system, unit, links, tolerance) for unit in units]
    by_drop = np.array([fluxes(surfaces, faces, points, each.velocity) for each, _ in responses]).T
    missing = np.linalg.solve(by_drop, wanted - fluxes(surfaces, faces, points, solution.velocity))
    for drop, (each, of_links) in zip(missing, responses, strict=True):
        solution, force = _plus(solution, each, drop), force + drop * of_links
    return Driven(solution, force, load + _combined(units, missing, system)[0])


def fluxes(surfaces: Surfaces, faces: Sequence[Face], node_points: FloatArray, velocity: FloatArray) -> FloatArray:
    """Fluxes ∫ u·n into the domain through ``faces`` (c,) of a ``velocity`` (nodes, d) [length^d/time]."""
    return np.asarray(surfaces.ranks.sum(np.array([face.inflow(node_points, velocity).sum() for face in faces])))


def _unit_drop(surfaces: Surfaces, face: Face, node_points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Load (nodes, d) and pressure jump (vertices,) of a unit drop of pressure from a face on."""
    load = np.zeros_like(node_points)
    np.add.at(load, face.facet_nodes, face.area_vectors(node_points))
    return load, surfaces.unit_jump(face.condition.surface)


def _combined(
    units: Sequence[tuple[FloatArray, FloatArray]], drops: FloatArray, system: CoupledSystem
) -> tuple[FloatArray, FloatArray]:
    """Load (nodes, d) and pressure jump (vertices,) of ``drops`` (c,), each times its unit."""
    load, jump = np.zeros_like(system.load), np.zeros_like(system.pressure_jump)
    for drop, (unit_load, unit_jump) in zip(drops, units, strict=True):
        load, jump = load + drop * unit_load, jump + drop * unit_jump
    return load, jump


def _response(
    discretisation: Discretisation,
    system: CoupledSystem,
    unit: tuple[FloatArray, FloatArray],
    links: Links,
    tolerance: float,
) -> tuple[Solution, FloatArray]:
    """Solution and forces of links by one ``unit`` drop alone, all that is prescribed at rest."""
    frame, (load, jump) = system.matrix.frame, unit
    alone = replace(
        system,
        load=load,
        body_load=np.zeros_like(system.body_load),
        prescribed=np.broadcast_to(frame, load.shape).copy(),  # the equations are of u less the frame's velocity
        velocity=np.zeros_like(load),
        pressure=jump,
        twist=np.zeros_like(system.twist),
        pressure_jump=jump,
        scale=0.0,
        again=True,
    )
    found, force = solve_linked(discretisation, alone, replace(links, rate=np.zeros_like(links.rate)), tolerance)
    return replace(found, velocity=found.velocity - frame), force


def _plus(solution: Solution, other: Solution, factor: float) -> Solution:
    """A ``solution`` and ``factor`` times another, whose prescribed velocities and twists are zero."""
    here, there = solution.jump_load, other.jump_load
    assert there is not None, "a drop has a jump"
    return Solution(
        velocity=solution.velocity + factor * other.velocity,
        pressure=solution.pressure + factor * other.pressure,
        twist=solution.twist + factor * other.twist,
        reaction=solution.reaction + factor * other.reaction,
        jump_load=factor * there if here is None else here + factor * there,
    )
