"""Slope of a study's figure over a parameter, by the derivatives that a run has recorded."""

from __future__ import annotations

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.history import History
from rigidfluid.post.studies.model import FigureTable


def read_slope(figure: FigureTable, history: History, parameter: str | None) -> float | None:
    """Derivative of a figure of bodies.csv by the value of a ``parameter``, in a run with ``output.sensitivities``.

    None where the run has none by this key at the time of the figure. The time of an extreme changes with the parameter
    too, which changes the extreme by nothing.
    """
    if figure.table != "bodies" or figure.column not in history.columns["sensitivities"]:
        return None
    table, bodies = history.sensitivities, history.bodies
    body = figure.body or bodies["body"][0]
    if len(table["time"]) == 0:
        return None
    rows = (table["parameter"] == parameter) & (table["body"] == body)
    times, slopes = table["time"][rows], table[figure.column][rows]
    if figure.at is None:
        own = bodies["body"] == body
        values = bodies[figure.column][own]
        extreme = values.argmax() if figure.extreme == "highest" else values.argmin()
        there = slopes[times == bodies["time"][own][extreme]]
        return float(there[0]) if len(there) else None
    return _interpolated(times, slopes, figure.at)


def _interpolated(times: FloatArray, slopes: FloatArray, at: float) -> float | None:
    from scipy.interpolate import CubicSpline

    within = len(times) > 1 and times[0] <= at <= times[-1]
    return float(CubicSpline(times, slopes)(at)) if within else None
