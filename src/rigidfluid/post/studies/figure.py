"""One number from a run: a value of its summary, or a column of one of its tables at a time or its extreme."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import columns
from rigidfluid.core.output.tables import KINDS
from rigidfluid.core.run.summary import ENERGIES, FIGURES
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.errors import SceneError
from rigidfluid.post.studies.model import FigureTable

_FIELD = "error.figure"


def check_figure(figure: FigureTable, scene: Scene) -> None:
    """Raise SceneError, with the nearest name that exists, for a figure that this scene's runs will not have."""
    if figure.key is not None:
        table, _, rest = figure.key.partition(".")
        only_with = {
            "cycles": scene.mechanism,
            "mesh_error": model_of(scene).fluid.estimates_errors,
            "error_estimates": scene.output.error_bars,
            "exchanges": scene.source or scene.sink,
        }
        _refuse_unknown("", table, [name for name in FIGURES if only_with.get(name, True)])
        if table == "energy":
            _refuse_unknown("", rest, ENERGIES)
        return
    names = columns(scene.dimension, periodic=bool(model_of(scene).domain.periodic))[str(figure.table)]
    _refuse_unknown(".column", str(figure.column), [name for name in names if KINDS.get(name) is not str])
    if figure.table == "probes" and (figure.probe or 0) >= len(scene.output.probes):
        allowed = f"the number of one of {len(scene.output.probes)} probes, from 0"
        raise SceneError(
            f"{_FIELD}.probe", figure.probe or 0, allowed, "Correct it, or add output.probes to the scene."
        )
    _check_flux(figure, scene)
    if figure.body is not None:
        _refuse_unknown(".body", figure.body, [body.name for body in model_of(scene).all_bodies])
    if figure.at is not None and not 0 <= figure.at <= scene.time.end:
        allowed = f"a time from 0 to time.end, {scene.time.end:g}"
        raise SceneError(f"{_FIELD}.at", figure.at, allowed, "Correct it, or run for longer.")


def _check_flux(figure: FigureTable, scene: Scene) -> None:
    """Refuse tables of fluxes that the scene's runs leave empty, and surfaces that they do not have."""
    if figure.table in ("scalar", "scalar_fluxes") and scene.scalar is None:
        raise SceneError(f"{_FIELD}.table", repr(figure.table), "that of a scene with [scalar]", "Choose another one.")
    if figure.table not in ("driving", "scalar_fluxes"):
        return
    model = model_of(scene)
    known = model.surfaces
    if figure.table == "driving":
        known = tuple(each.name for each in model.conditions if each.image is not None) if model.wet else ()
    if not known:
        allowed = "that of a scene with a fluid between periodic surfaces"
        raise SceneError(f"{_FIELD}.table", repr(figure.table), allowed, "Choose another one.")
    if figure.surface is not None:
        _refuse_unknown(".surface", figure.surface, known)


def read_figure(figure: FigureTable, history: History) -> float:
    """Figure of a complete run, finite; raises SceneError if the run has no such number."""
    value = _summary_value(figure.key, history.summary) if figure.key is not None else _table_value(figure, history)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise SceneError(f"{_FIELD}", f"{value!r} for {figure}", "a number", "Choose a figure that this run has.")
    return float(value)


def _summary_value(path: str, summary: dict[str, Any]) -> Any:
    value: Any = summary
    for key in path.split("."):
        if isinstance(value, list) and key.isdecimal() and int(key) < len(value):
            value = value[int(key)]
        elif isinstance(value, dict) and key in value:
            value = value[key]
        else:
            _refuse_unknown("", key, value if isinstance(value, dict) else ())
    return value


def _table_value(figure: FigureTable, history: History) -> float:
    table = history.table(str(figure.table))
    rows = _rows(figure, table)
    values: FloatArray = table[str(figure.column)][rows]
    if len(values) == 0:
        return math.nan
    if figure.at is not None:
        return _interpolated(table["time"][rows], values, figure.at)
    return float(values.max() if figure.extreme == "highest" else values.min())


def _rows(figure: FigureTable, table: dict[str, NDArray[Any]]) -> BoolArray:
    """Rows (s,) of one body, one probe or one surface; in the table of contacts, rows of one body or of all."""
    if figure.table == "bodies":
        return np.asarray(table["body"] == (figure.body or table["body"][0]))
    if figure.table == "probes":
        return np.asarray(table["probe"] == (figure.probe or 0))
    if figure.table in ("driving", "scalar_fluxes"):
        return np.asarray(table["surface"] == (figure.surface or table["surface"][:1]))
    if figure.body is not None:
        return np.asarray((table["a"] == figure.body) | (table["b"] == figure.body))
    return np.ones(len(table["time"]), dtype=bool)


def _interpolated(time: FloatArray, values: FloatArray, at: float) -> float:
    from scipy.interpolate import CubicSpline

    return float(CubicSpline(time, values)(at)) if np.isfinite(values).all() else math.nan


def _refuse_unknown(below: str, name: str, known: Iterable[str]) -> None:
    names = list(known)
    if name not in names:
        remedy = suggestion(name, names) or "Choose one of them."
        raise SceneError(_FIELD + below, repr(name), "one of " + ", ".join(names), remedy)
