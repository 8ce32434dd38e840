"""Conditions that a scene sets on the domain's surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial, singledispatch

from rigidfluid.core.case.boundary_tables import Place, placed_tables
from rigidfluid.core.case.boundary_values import (
    held_flux,
    prescribed_pressure,
    prescribed_velocity,
    pressure_drop,
    wall_velocity,
)
from rigidfluid.core.fluid.conditions import (
    NoSlip,
    Periodic,
    PrescribedPressure,
    PrescribedVelocity,
    Slip,
    no_pressure,
)
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.scene.boundary_tables import (
    BoundaryTable,
    PeriodicTable,
    PressureTable,
    SlipTable,
    VelocityTable,
    WallTable,
)
from rigidfluid.core.setup.model import ConditionMaker


def condition_makers(tables: Sequence[BoundaryTable], domain: Domain) -> dict[str, ConditionMaker]:
    """Maker of the condition on each surface of the domain, by its name; raises SceneError for values that cannot be
    there."""
    return {place.piece.name: condition_maker(table, place) for table, place in placed_tables(tables, domain)}


@singledispatch
def condition_maker(table: BoundaryTable, place: Place) -> ConditionMaker:
    """Maker of the condition of a table at a place; raises SceneError for values that cannot be there.

    Each class of tables has its own function below.
    """
    raise NotImplementedError(type(table).__name__)


@condition_maker.register(WallTable)
def _no_slip(table: WallTable, place: Place) -> ConditionMaker:
    return partial(NoSlip, sliding=wall_velocity(table, place.dimension), field=place.at)


@condition_maker.register(VelocityTable)
def _prescribed_velocity(table: VelocityTable, place: Place) -> ConditionMaker:
    return partial(PrescribedVelocity, value=prescribed_velocity(table, place), field=place.at)


@condition_maker.register(PressureTable)
def _prescribed_pressure(table: PressureTable, place: Place) -> ConditionMaker:
    return partial(PrescribedPressure, value=prescribed_pressure(table, place), field=place.at)


@condition_maker.register(SlipTable)
def _slip(table: SlipTable, place: Place) -> ConditionMaker:
    return partial(Slip, field=place.at)


@condition_maker.register(PeriodicTable)
def _periodic(table: PeriodicTable, place: Place) -> ConditionMaker:
    drop = pressure_drop(table, place)
    return partial(
        Periodic, drop=no_pressure if drop is None else drop, held_flux=held_flux(table, place), field=place.at
    )
