"""Units of a scene's keys and of a run's figures, for labels of axes."""

from __future__ import annotations

from pydantic import BaseModel

from rigidfluid.core.case.key_quantity import key_quantity
from rigidfluid.core.output.column_quantity import column_quantity, summary_quantity
from rigidfluid.core.scene.quantity import plain_quantity
from rigidfluid.post.reports.units import Units
from rigidfluid.post.studies.model import FigureTable


def key_unit(scene: BaseModel, key: str, units: Units) -> str:
    """Unit of a scene's key ("body.0.density") in brackets after a space; empty where it has none or none is named."""
    return _named(key_quantity(scene, key), units)


def figure_unit(figure: FigureTable, units: Units) -> str:
    """The same of a figure of a run."""
    if figure.key is not None:
        return _named(summary_quantity(figure.key), units)
    return _named(column_quantity(str(figure.column), units.dimension), units)


def _named(quantity: str, units: Units) -> str:
    """A quantity by names of units, in so many dimensions; empty where a part of it has no name."""
    if units.names is None or not quantity:
        return ""
    plain = plain_quantity(quantity, units.dimension)
    named = units.put_into(f"[{plain}]")
    return "" if named in (f"[{plain}]", "[1]") else f" {named}"
