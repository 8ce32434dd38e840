"""Quantities that columns of a run's tables and keys of its summary hold."""

from __future__ import annotations

from rigidfluid.core.output.records import LEDGER_COLUMNS, quantity_columns, wrapped_columns

_IN_BODIES = {
    "position": "length",
    "orientation": "rad",
    "velocity": "length/time",
    "angular_velocity": "rad/time",
    "force": "force",
    "torque": "force·length",
    "contact_force": "force",
    "contact_torque": "force·length",
}
"""Quantities of a table of bodies, some of which other tables have too."""

_ALONE = {
    **{"time": "time", "gap": "length", "size": "time", "pressure": "force/length^(d-1)", "area": "length^(d-1)"},
    **dict.fromkeys(("contact_fx", "contact_fy", "contact_fz"), "force"),
    "mass": "mass",
    **dict.fromkeys(("px", "py", "pz"), "mass·length/time"),
    **dict.fromkeys(("l", "lx", "ly", "lz"), "mass·length²/time"),
}


def column_quantity(column: str, dimension: int) -> str:
    """Quantity of a table's column, as "length/time"; empty of a number without one."""
    if column in LEDGER_COLUMNS:
        return "energy"
    columns = quantity_columns(dimension)
    if column in wrapped_columns(dimension):
        return "length"
    return next((_IN_BODIES[name] for name in columns if column in columns[name]), _ALONE.get(column, ""))


def summary_quantity(path: str) -> str:
    """The same of a key path of summary.json."""
    table, _, key = path.partition(".")
    if table == "energy":
        return "" if "relative" in key else "energy"
    if table == "exchanges":
        return _in_exchanges(key)
    return {"time": "time", "smallest_gap": "length"}.get(table, "")


def _in_exchanges(key: str) -> str:
    """Quantity of a key of the account of bodies that entered and left."""
    part, _, name = key.partition(".")
    vectors = {"momentum": "mass·length/time", "angular_momentum": "mass·length²/time"}
    known = {"mass": "mass", "kinetic": "energy", **vectors}
    return {"mass": "mass", "energy": "energy"}.get(part, known.get(name.partition(".")[0], ""))
