"""Drops of pressure between periodic faces that drive given fluxes through them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Links
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.elements.face import Face
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.system.anchor import adrift, anchor, is_adrift
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
    free bodies respond in each of these. Velocities of an `Anchor` are such unknowns as well.

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
    held, faces = held_faces(surfaces)
    if not held:
        return Driven(*_solve_undriven(discretisation, system, links, tolerance), np.zeros_like(system.load))
    wanted = np.array([face.condition.held_flux(time) for face in faces if face.condition.held_flux is not None])
    held_still = anchor(surfaces, system.matrix, links, np.array([face.condition.normal for face in faces]))
    units = [unit_drop(surfaces, face, system) for face in faces]
    units += [replace(units[0].nothing(), body_load=load) for load in held_still.loads(system.body_load)]

    def missed(solution: Solution) -> FloatArray:
        """Fluxes of a solution, and the velocities of what is anchored."""
        through = fluxes(surfaces, faces, points, solution.velocity)
        return np.concatenate([through, held_still.velocities(solution.twist)])

    expected = np.concatenate([surfaces.pressure_drops(system.pressure)[held], held_still.velocities(system.twist)])
    own = np.concatenate([np.zeros(len(faces)), np.ones(len(units) - len(faces))])
    matrix = held_still.added_to(system.matrix) if len(units) > len(faces) else system.matrix
    system = replace(system, matrix=matrix)
    driving = _combined(units, expected)
    solution, force = solve_linked(discretisation, driving.added_to(system), links, tolerance)
    responses = [_response(discretisation, system, unit, links, tolerance) for unit in units]
    by_unit = np.array([missed(each) for each, _ in responses]).T - np.diag(own)
    goal = np.concatenate([wanted, expected[len(faces) :]])
    change = np.linalg.solve(by_unit, goal - missed(solution))
    for factor, (each, of_links) in zip(change, responses, strict=True):
        solution, force = _plus(solution, each, factor), force + factor * of_links
    return Driven(solution, force, driving.load + _combined(units, change).load)


def _solve_undriven(
    discretisation: Discretisation, system: CoupledSystem, links: Links, tolerance: float
) -> tuple[Solution, FloatArray]:
    """Solve without held fluxes; where that fails, tell if these are what lacks."""
    try:
        return solve_linked(discretisation, system, links, tolerance)
    except StepRejected as error:
        if is_adrift(discretisation.surfaces, system.matrix, links):
            raise adrift("no flux") from error
        raise


def fluxes(surfaces: Surfaces, faces: Sequence[Face], node_points: FloatArray, velocity: FloatArray) -> FloatArray:
    """Fluxes ∫ u·n into the domain through ``faces`` (c,) of a ``velocity`` (nodes, d) [length^d/time]."""
    return np.asarray(surfaces.ranks.sum(np.array([face.inflow(node_points, velocity).sum() for face in faces])))


@dataclass(frozen=True, eq=False)
class Unit:
    """Right side of a unit of one unknown: ``load`` (nodes, d) and pressure ``jump`` (vertices,) of a drop, or
    ``body_load`` (N, d+k) of an anchor."""

    load: FloatArray
    jump: FloatArray
    body_load: FloatArray

    def nothing(self) -> Unit:
        return Unit(*(np.zeros_like(each) for each in (self.load, self.jump, self.body_load)))

    def added_to(self, system: CoupledSystem) -> CoupledSystem:
        return replace(
            system,
            load=system.load + self.load,
            pressure_jump=system.pressure_jump + self.jump,
            body_load=system.body_load + self.body_load,
        )


def held_faces(surfaces: Surfaces) -> tuple[list[int], list[Face]]:
    """Numbers among the first faces of periodic pairs, (h,), of those whose flux is held, and these faces."""
    held = [number for number, face in enumerate(surfaces.first_faces) if face.condition.held_flux is not None]
    return held, [surfaces.first_faces[number] for number in held]


def driving_load(surfaces: Surfaces, system: CoupledSystem) -> FloatArray:
    """Load (nodes, d) of the drops in the pressure of a ``system`` on the faces whose flux is held."""
    held, faces = held_faces(surfaces)
    if not held:
        return np.zeros_like(system.load)
    drops = surfaces.pressure_drops(system.pressure)[held]
    return _combined([unit_drop(surfaces, face, system) for face in faces], drops).load


def unit_drop(surfaces: Surfaces, face: Face, system: CoupledSystem) -> Unit:
    """Load and pressure jump of a unit drop of pressure from a face on."""
    points, load = system.matrix.node_points, np.zeros_like(system.load)
    np.add.at(load, face.facet_nodes, face.area_vectors(points))
    return Unit(load, surfaces.unit_jump(face.condition.surface), np.zeros_like(system.body_load))


def _combined(units: Sequence[Unit], factors: FloatArray) -> Unit:
    """The ``units``, each times its factor, added up."""
    found = units[0].nothing()
    for factor, unit in zip(factors, units, strict=True):
        found = Unit(
            found.load + factor * unit.load,
            found.jump + factor * unit.jump,
            found.body_load + factor * unit.body_load,
        )
    return found


def _response(
    discretisation: Discretisation,
    system: CoupledSystem,
    unit: Unit,
    links: Links,
    tolerance: float,
) -> tuple[Solution, FloatArray]:
    """Solution and forces of links by one ``unit`` alone, all that is prescribed at rest."""
    frame = system.matrix.frame
    alone = replace(
        system,
        load=unit.load,
        body_load=unit.body_load,
        prescribed=np.broadcast_to(frame, unit.load.shape).copy(),  # the equations are of u less the frame's velocity
        velocity=np.zeros_like(unit.load),
        pressure=unit.jump,
        twist=np.zeros_like(system.twist),
        pressure_jump=unit.jump,
        scale=0.0,
        again=True,
    )
    found, force = solve_linked(discretisation, alone, replace(links, rate=np.zeros_like(links.rate)), tolerance)
    return replace(found, velocity=found.velocity - frame), force


def _plus(solution: Solution, other: Solution, factor: float) -> Solution:
    """A ``solution`` and ``factor`` times another, whose prescribed velocities and twists are zero."""
    jumps = [(1.0, solution.jump_load), (factor, other.jump_load)]
    jump_loads = [weight * load for weight, load in jumps if load is not None]
    return Solution(
        velocity=solution.velocity + factor * other.velocity,
        pressure=solution.pressure + factor * other.pressure,
        twist=solution.twist + factor * other.twist,
        reaction=solution.reaction + factor * other.reaction,
        jump_load=sum(jump_loads[1:], jump_loads[0]) if jump_loads else None,
    )
