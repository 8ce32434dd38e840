"""Checks of a scene's sources and sinks, before it runs."""

from __future__ import annotations

from rigidfluid.core.case.population_due import body_alone
from rigidfluid.core.case.sinks import rule
from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.scene.exchange_tables import SinkTable, SourceTable
from rigidfluid.core.seeding.draws import Draws
from rigidfluid.core.seeding.placement import refuse_outside
from rigidfluid.core.seeding.regions import DomainRegion, region_of
from rigidfluid.core.seeding.swarm import swarm_of
from rigidfluid.core.setup.changeable import require_changeable
from rigidfluid.core.setup.fluid import Fluid
from rigidfluid.core.setup.mesh_checks import check_inserter
from rigidfluid.core.setup.model import Model
from rigidfluid.errors import SceneError


def check_exchange(model: Model) -> None:
    """Raise SceneError or PluginError for sources and sinks that are wrong, or that bodies of the model cannot have."""
    with all_told() as ask:
        ask(require_changeable, model)
        ask(_refuse_error_bars, model)
        for number, source in enumerate(model.source_tables):
            ask(_check_source, source, number, model)
        for number, sink in enumerate(model.sink_tables):
            ask(_check_sink, sink, f"sink.{number}", model)


def _refuse_error_bars(model: Model) -> None:
    if model.output.error_bars:
        found = "true with bodies that enter or leave"
        raise SceneError("output.error_bars", found, "false with sources and sinks", "Leave it out.")


def _check_source(table: SourceTable, number: int, model: Model) -> None:
    at = f"source.{number}"
    if (table.times is None) == (table.every is None):
        found = "neither" if table.times is None else "both"
        raise SceneError(f"{at}.every", f"{found} of times and every", "one of them", "Say when bodies enter.")
    if table.times is not None and (table.number is not None or table.start):
        key = "start" if table.start else "number"
        raise SceneError(f"{at}.{key}", f"{key} together with times", f"{key} with every", "Leave it out.")
    if table.times is not None and sorted(table.times) != list(table.times):
        raise SceneError(f"{at}.times", list(table.times), "times in order", "Sort them.")
    others = [other.name for other in model.source_tables if other is not table]
    alike = [name for name in (*model.surfaces, *others) if table.gives(name)]
    alike += [name for name in others if name == table.name]
    if alike:
        allowed = f"a name whose numbers, as {table.name}0, nobody else has: there is {alike[0]!r}"
        raise SceneError(f"{at}.name", repr(table.name), allowed, "Choose another name.")
    body_alone(model, number, 0)
    shapes = swarm_of(table.swarm(0), at, model.dimension, Draws(model.seed), model.registry).shapes
    if isinstance(model.fluid, Fluid):
        check_inserter(model.fluid.mesh, shapes, model.domain, f"{at}.shape")
    if model.names_detector:
        model.detection[0].part(model.detection[0].options, (*model.shapes, *shapes), model.walls)


def _check_sink(table: SinkTable, at: str, model: Model) -> None:
    if table.region is not None and table.on is not None:
        raise SceneError(f"{at}.on", "both of region and on", "one of them", "Write two sinks, or leave one out.")
    if table.region is None and table.on is None and table.when is None:
        raise SceneError(f"{at}.on", "none of region, on and when", "one at least", "Say where or when bodies leave.")
    if table.when is not None:
        rule(table.when, f"{at}.when", model.dimension)
    if table.gap is not None and table.on is None:
        raise SceneError(f"{at}.gap", "gap without on", "gap with on", "Leave it out, or name the surface.")
    if table.region is not None:
        region = region_of(table.region, model.domain, f"{at}.region", model.registry)
        refuse_outside(region, DomainRegion(model.domain), f"{at}.region", Draws(model.seed))
    elif table.on is not None and table.on not in model.domain.names:
        raise SceneError(
            f"{at}.on", repr(table.on), f"a surface: {', '.join(model.domain.names)}", "Name one of these."
        )
