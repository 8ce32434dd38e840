"""Features that a scene switches on and off, and why; `rigidfluid check` prints them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.contact.laws.friction import Friction
from rigidfluid.core.contact.laws.restitution import Restitution
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.wrapped_law import bare, layer
from rigidfluid.described import first_names

if TYPE_CHECKING:
    from rigidfluid.core.fluid.fluid_problem import FluidProblem
    from rigidfluid.core.model.interactions import Interaction
    from rigidfluid.core.model.system import System
    from rigidfluid.core.scene.mesh_tables import MeshTable


@dataclass(frozen=True)
class Feature:
    """One thing that costs time, whether this scene has it, and why."""

    name: str
    on: bool
    why: str


def features(system: System, mesh: MeshTable | None, sources: int = 0, sinks: int = 0) -> Iterator[Feature]:
    """Yield each feature that a scene with so many ``sources`` and ``sinks`` may have: whether it is on, and why."""
    problem, backend = system.fluid, system.backend_type
    if problem is None:
        yield Feature("fluid", False, f"backend {backend.name!r} has no viscosity to work with")
    else:
        yield Feature("fluid", True, f"backend {backend.name!r}")
        yield from _fluid(problem)
    yield from _mesh(system, mesh)
    yield from _contact(system)
    yield _joints(system)
    yield _count("prescribed motion", system.prescribed, "fixed or prescribed")
    tables = f"number of tables: {sources} [[source]], {sinks} [[sink]]"
    yield Feature("bodies that enter or leave", sources + sinks > 0, tables)


def _fluid(problem: FluidProblem) -> Iterator[Feature]:
    model = "navier-stokes" if problem.inertia else "stokes"
    yield Feature("inertia of the fluid", problem.inertia, f"model {model!r}")
    varies = isinstance(problem.material, GeneralisedNewtonian)
    yield Feature("viscosity that varies", varies, f"material {problem.material.name!r}")
    outlets = [condition.name for condition in problem.conditions if condition.is_open]
    why = f"pressure is given on {', '.join(outlets)}" if outlets else "no face gives a pressure"
    yield Feature("pressure fixed by a constraint", not outlets, why)
    given = "not given" if problem.source is None else "given"
    yield Feature("force on the fluid", problem.source is not None, f"fluid.force is {given}")
    start = problem.initial if isinstance(problem.initial, str) else "given by expressions"
    yield Feature("flow at the start", start != "rest", f"fluid.initial is {start}")
    yield _scalar(problem)


def _scalar(problem: FluidProblem) -> Feature:
    if problem.scalar is None:
        return Feature("scalar in the fluid", False, "no table [scalar]")
    felt = "not felt by the flow" if problem.scalar.buoyancy is None else "with buoyancy"
    conducting = sum(condition.conduction is not None for condition in problem.scalar.conditions)
    return Feature("scalar in the fluid", True, felt + (f"; bodies that conduct: {conducting}" if conducting else ""))


def _mesh(system: System, mesh: MeshTable | None) -> Iterator[Feature]:
    wet, backend = system.has_fluid, system.backend_type.name
    yield Feature("mesh", wet, f"backend {backend!r} needs {'one' if wet else 'none'}")
    if wet:
        turning = np.array([body.radius is None for body in system.bodies])
        yield _count("rotation of the mesh", turning, "no balls")
        yield _window(system)
    if wet and mesh:
        yield Feature("boxes of finer cells", bool(mesh.refine), f"[[mesh.refine]] names {len(mesh.refine) or 'none'}")
        yield _wake(mesh)
        fields = ", ".join(repr(table.type) for table in mesh.field)
        yield Feature("cells by size fields", bool(mesh.field), f"[[mesh.field]] names {fields or 'none'}")
        age = mesh.remesh_every
        why = "mesh.remesh_every is not given" if age is None else f"mesh.remesh_every is {age:g}"
        yield Feature("re-meshing by age", age is not None, why)


def _window(system: System) -> Feature:
    window = system.window
    why = "no table [domain.window]" if window is None else f"it goes with {system.surfaces[window.body]!r}"
    return Feature("window in the domain", window is not None, why)


def _wake(mesh: MeshTable) -> Feature:
    wake = mesh.wake
    why = "no table [mesh.wake]" if wake is None else f"cells of {wake.size:g} where bodies were for {wake.time:g}"
    return Feature("finer cells in wakes", wake is not None, why)


def _contact(system: System) -> Iterator[Feature]:
    yield _sliding(system)
    names = ", ".join(wall.name for wall in system.walls) or "none"
    if system.law is None:
        yield Feature("contact forces", False, "the scene names no law")
    else:
        yield Feature("contact forces", True, "; ".join(_law(system, one) for one in system.interactions))
        yield Feature("repelling walls", bool(system.walls), names)
        parts = np.bincount(system.assembly, minlength=1)[system.assembly] > 1
        yield _count("components that do not repel each other", parts, "parts of an articulated body")
    yield Feature("contact detection", True, f"detector {system.detector.name!r}, {system.detector_why}")
    yield _measured(system.reach)


def _joints(system: System) -> Feature:
    linked = system.joints.linked
    if not linked.any():
        return Feature("joints", False, "no table [[joint]], no body with `free` or `spring`, no long-range force")
    return Feature("joints", True, f"they hold or pull {int(np.count_nonzero(linked))} of {len(linked)} motions")


def _law(system: System, interaction: Interaction) -> str:
    law = interaction.law
    text = f"law {bare(law).name!r} below a gap of {law.range}"
    restitution, friction = layer(Restitution, law), layer(Friction, law)
    if restitution:
        text += f" with a restitution of {restitution.restitution:g}"
        text += "" if restitution.loss is None else restitution.loss.words
    if friction:
        text += f"{' and' if restitution else ' with'} a friction of {friction.friction:g}"
    if interaction.between != "all":
        text += {"walls": " at walls", "pairs": " between bodies"}[interaction.between]
    names = " and ".join(_group([system.surfaces[surface] for surface in group]) for group in interaction.surfaces)
    return f"{text} ({names})" if names else text


def _group(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"any of {first_names(names)}" if names else "bodies that may enter"


def _sliding(system: System) -> Feature:
    names = ", ".join(wall.name for wall in system.walls if wall.velocity is not None)
    return Feature("walls that slide", bool(names), names or "no wall has a velocity")


def _measured(reach: float) -> Feature:
    return Feature(
        "smallest gap recorded", reach > 0, f"up to {reach:.4g}" if np.isfinite(reach) else "at any distance"
    )


def _count(name: str, bodies: np.ndarray[tuple[int], np.dtype[np.bool_]], what: str) -> Feature:
    count = int(np.count_nonzero(bodies))
    return Feature(name, count > 0, f"{count} of {len(bodies)} bodies are {what}")
