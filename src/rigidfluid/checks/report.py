"""Report of all questions, asked of one scene before any heavy work."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import chain
from typing import Any

import numpy as np

from rigidfluid.checks.attraction import attraction_findings
from rigidfluid.checks.boundary_layer import layer_findings
from rigidfluid.checks.design_contacts import design_contacts
from rigidfluid.checks.domain_rows import DomainRow, domain_row
from rigidfluid.checks.energy_error import energy_error_findings
from rigidfluid.checks.film import film_findings
from rigidfluid.checks.finding import GRADES, Finding
from rigidfluid.checks.free_fall import free_fall_findings
from rigidfluid.checks.impact import impact_findings
from rigidfluid.checks.joints import joint_findings
from rigidfluid.checks.mechanisms import mechanism_findings
from rigidfluid.checks.memory import memory_findings
from rigidfluid.checks.overridden import overridden_findings
from rigidfluid.checks.pair_rows import PairRow, pair_rows
from rigidfluid.checks.periodic import periodic_findings
from rigidfluid.checks.range_checks import parallel_wall_findings, range_findings, start_findings
from rigidfluid.checks.rebound import rebound_findings
from rigidfluid.checks.resolution import resolution_findings
from rigidfluid.checks.run_size import run_size
from rigidfluid.checks.run_time import dry_run_time_findings, run_time_findings
from rigidfluid.checks.separation import law_findings, open_face_findings, strength_findings
from rigidfluid.checks.shapes import facet_findings
from rigidfluid.checks.sources import source_findings, with_first_bodies
from rigidfluid.checks.static_load import rest_findings, stack_findings
from rigidfluid.checks.stepping import step_findings
from rigidfluid.checks.swarms import swarm_findings
from rigidfluid.checks.tolerance import tolerance_findings
from rigidfluid.checks.units import unit_findings
from rigidfluid.core.case.population import assemble_ever
from rigidfluid.core.case.scene_model import Case, model_of
from rigidfluid.core.contact.laws.spot_check import spot_check
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.foreign import no_exit
from rigidfluid.core.model.memory import told_memory
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.run.neighbour_systems import system_pairs
from rigidfluid.core.setup.assemble import assemble, gap_reach
from rigidfluid.core.setup.features import Feature, features
from rigidfluid.core.setup.geometry_checks import initial_contacts
from rigidfluid.core.setup.model import Model


@dataclass(frozen=True)
class BodyRow:
    """One body as the run will start: ``submerged_weight`` (m - ρV)g, ``added_mass`` and ``impact_speed`` as estimated.

    ``smallest_gap`` is None, and ``nearest`` empty, where nothing is near.
    """

    name: str
    type: str
    mass: float
    added_mass: float
    submerged_weight: tuple[float, ...]
    impact_speed: float
    smallest_gap: float | None
    nearest: str


@dataclass(frozen=True)
class Report:
    """Answers of a check: the domain, features switched on and off, bodies, kinds of pairs, and findings, the gravest
    first."""

    scene: str
    domain: DomainRow
    features: tuple[Feature, ...]
    bodies: tuple[BodyRow, ...]
    pairs: tuple[PairRow, ...]
    findings: tuple[Finding, ...]

    def count(self, grade: str) -> int:
        """Number of findings of this grade."""
        return sum(finding.grade == grade for finding in self.findings)

    def to_dict(self) -> dict[str, Any]:
        """Values of the report that JSON can hold."""
        return {
            "scene": self.scene,
            **{f"{grade}s": self.count(grade) for grade in GRADES},
            "domain": asdict(self.domain),
            "features": [asdict(feature) for feature in self.features],
            "bodies": [asdict(body) for body in self.bodies],
            "pairs": [asdict(pair) for pair in self.pairs],
            "findings": [finding.to_dict() for finding in self.findings],
        }


def check(case: Case) -> Report:
    """Ask all questions of a scene or a model, without making a mesh; raises RigidfluidError if it cannot be built at
    all."""
    with no_exit(), told_memory():
        model = model_of(case)
        system = assemble(model)
        judged = with_first_bodies(model)
        whole = assemble_ever(judged) if model.source_tables else system
        start = initial_contacts(model, system.pose, gap_reach(system))
        spot_check(system, system.pose, None, 0)
        if model.output.sensitivities:
            system_pairs(model.document, system, model.output.sensitivities)
        answers = chain(findings(judged, whole), _findings_at_start(model, system, start))
        found = sorted(answers, key=lambda finding: GRADES.index(finding.grade))
        rows = (
            tuple(features(system, model.fluid.mesh, len(model.source_tables), len(model.sink_tables))),
            tuple(_rows(system, start)),
        )
        pairs = tuple(pair_rows(whole, model.fluid.mesh))
        return Report(model.name, domain_row(model), *rows, pairs, tuple(found))


def _findings_at_start(model: Model, system: System, start: Contacts) -> Iterator[Finding]:
    """The answers to questions about bodies where they start."""
    mesh = model.fluid.mesh
    size = None if mesh is None else run_size(model, system, mesh)
    if size is not None:
        yield from chain(memory_findings(size), run_time_findings(size, system, model.time))
    yield from periodic_findings(system)
    for interaction in system.interactions:
        yield from start_findings(system, interaction, start)


def findings(model: Model, system: System) -> Iterator[Finding]:
    """The answers to all questions about bodies wherever they are, in the order in which they are asked."""
    mesh, time = model.fluid.mesh, model.time
    ends = {sink.on for sink in model.sink_tables if sink.when is None}
    yield from chain(law_findings(system), open_face_findings(system, ends), strength_findings(system))
    yield from chain(overridden_findings(model.boundary_tables, model.domain), swarm_findings(model.swarm_tables))
    yield from chain(source_findings(model), free_fall_findings(model, system))
    yield from chain(unit_findings(model, system), tolerance_findings(time), facet_findings(system))
    yield from chain(joint_findings(model, system), mechanism_findings(model, system))
    yield from attraction_findings(model, system)
    if system.fluid is None:
        yield from dry_run_time_findings(system, time)
    if mesh is not None:
        yield from chain(layer_findings(system, mesh), film_findings(system, mesh))
    for design in design_contacts(system):
        yield from chain(rest_findings(design), stack_findings(design))
        yield from chain(impact_findings(design), step_findings(design, time))
        if mesh is not None:
            yield from resolution_findings(design, mesh)
        if mesh is not None and system.fluid is not None:
            yield from energy_error_findings(design, system.fluid, time.step)
        if mesh is not None and system.loads.film is not None:
            yield from rebound_findings(design, system.loads.film, mesh)
    for interaction in system.interactions:
        yield from chain(parallel_wall_findings(system, interaction), range_findings(system, interaction, mesh))


def _rows(system: System, start: Contacts) -> Iterator[BodyRow]:
    gaps, nearest = _nearest(system, start)
    for i, body in enumerate(system.bodies):
        yield BodyRow(
            name=system.surfaces[i],
            type=body.name,
            mass=float(system.mass[i]),
            added_mass=float(np.trace(system.added_mass[i])) / system.dimension,
            submerged_weight=tuple(system.weight[i].tolist()),
            impact_speed=float(system.loads.speed[i]),
            smallest_gap=float(gaps[i]) if np.isfinite(gaps[i]) else None,
            nearest=nearest[i],
        )


def _nearest(system: System, start: Contacts) -> tuple[FloatArray, list[str]]:
    """Gap of each body to the nearest body or repelling wall (n,), infinite where none is near, and that surface's
    name."""
    count = len(system.bodies)
    gaps, names = np.full(count, np.inf), [""] * count
    solid = {*range(count), *(wall.surface for wall in system.walls)}
    for a, b, gap in zip(start.body_a.tolist(), start.body_b.tolist(), start.gap.tolist(), strict=True):
        for body, other in ((a, b), (b, a)):
            if body < count and other in solid and gap < gaps[body]:
                gaps[body], names[body] = gap, system.surfaces[other]
    return gaps, names
