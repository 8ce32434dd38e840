"""Account of what bodies brought and took: masses, momenta and energies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import BoolArray
from rigidfluid.core.output.records import exchange_columns
from rigidfluid.core.run.exchange_rows import ENTERED, GONE

if TYPE_CHECKING:
    from rigidfluid.core.run.simulation import Simulation


def exchange_account(simulation: Simulation) -> dict[str, Any]:
    """Sums over the bodies that entered and left, the mass that is there beside those, and which part of the energy in
    the ledger's ``exchange`` was the bodies' own; empty where nobody did."""
    if not simulation.population:
        return {}
    table, dimension = simulation.history.exchanges, simulation.origin.dimension
    entered, gone = (_sums(table, table["change"] == change, dimension) for change in (ENTERED, GONE))
    start = sum(body.density * body.shape.volume for body in simulation.origin.all_bodies)
    there = float(simulation.system.mass.sum())
    mass = {"start": start, "entered": entered["mass"], "gone": gone["mass"], "there": there}
    own, exchange = entered["kinetic"] - gone["kinetic"], simulation.state.ledger.exchange
    return {
        "exchanges": {
            "mass": {**mass, "residual": start + mass["entered"] - mass["gone"] - there},
            "energy": {"exchange": exchange, "bodies": own, "fluid_and_contacts": exchange - own},
            ENTERED: entered,
            GONE: gone,
        }
    }


def _sums(table: dict[str, NDArray[Any]], rows: BoolArray, dimension: int) -> dict[str, Any]:
    """Number of these rows, and sums of what they hold, vectors as lists."""
    mass, *vectors, kinetic = (float(np.sum(table[name][rows])) for name in exchange_columns(dimension))
    momentum, angular = vectors[:dimension], vectors[dimension:]
    return {
        "bodies": int(rows.sum()),
        "mass": mass,
        "momentum": momentum,
        "angular_momentum": angular,
        "kinetic": kinetic,
    }
