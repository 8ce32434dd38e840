"""Row of the statistics of many bodies in one state."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.shear import Shear, shear_of_walls
from rigidfluid.core.mechanics.suspension import (
    contact_stress,
    coordination,
    mean_gap,
    mean_velocity,
    symmetric,
    velocity_fluctuations,
)
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.output.records import Row


def statistics_rows(system: System, state: State, time: float, forces: FloatArray) -> list[Row]:
    """One row of the table of statistics, none where no body moves; ``forces`` (m, d) are those of the contacts on
    their first bodies."""
    moves = np.append(~system.prescribed, np.zeros(len(system.surfaces) - len(system.bodies), dtype=bool))
    free = moves[: len(system.bodies)]
    count, volume = int(free.sum()), float(system.domain.volume)
    if count == 0:
        return []
    shear, velocity, position = shear_of_walls(system), state.twist.velocity[free], state.pose.position[free]
    near, acting = state.contacts, system.acting(state.contacts)
    number = np.where(moves, np.cumsum(moves) - 1, -1)
    a, b = number[near.body_a], number[near.body_b]
    paired = (a >= 0) & (b >= 0)
    by_contacts = contact_stress(forces[paired], _arms(state, paired), volume)
    total = _total_stress(state, free, by_contacts, volume)
    return [
        (
            *(time, state.count, count, float(system.volumes[free].sum()) / volume),
            *mean_velocity(velocity).tolist(),
            *velocity_fluctuations(velocity, position, shear).tolist(),
            float(mean_gap(state.gaps[free])),
            *(float(near.gap[chosen].min(initial=np.inf)) for chosen in (paired, (a >= 0) ^ (b >= 0))),
            *(coordination(count, a[acting], b[acting]), len(acting)),
            *by_contacts.ravel().tolist(),
            *total[np.triu_indices(system.dimension)].tolist(),
            *_shear_figures(shear, total),
        )
    ]


def _arms(state: State, paired: BoolArray) -> FloatArray:
    """Vectors (p, d) to the centre of the first body from that of the second one's image, in those of the contacts (m,)
    that are between bodies [length]."""
    near, centre = state.contacts, state.pose.position
    arms = centre[near.body_a[paired]] - centre[near.body_b[paired]]
    return arms if near.shift is None else arms - near.shift[paired]


def _total_stress(state: State, free: BoolArray, by_contacts: FloatArray, volume: float) -> FloatArray:
    """Stress of the ``free`` bodies (d, d), not a number without stresslets [force/length^(d-1)]."""
    if state.stresslet is None:
        return np.full_like(by_contacts, np.nan)
    return np.asarray(state.stresslet[free].sum(axis=0) / volume + symmetric(by_contacts))


def _shear_figures(shear: Shear | None, total: FloatArray) -> tuple[float, ...]:
    """Relative viscosity and normal stress differences of the ``total`` stress of the bodies (d, d), not a number where
    they are not defined."""
    if shear is None:
        return (np.nan,) * len(total)
    added = shear.added_viscosity(total)
    return (np.nan if added is None else 1.0 + float(added), *shear.normal_differences(total).tolist())
