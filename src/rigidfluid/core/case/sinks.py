"""Bodies that leave: in regions, near surfaces, and by rules about their state."""

from __future__ import annotations

from functools import cache

import numpy as np

from rigidfluid.core.case.moment import Moment, SinkRegions
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.nested.expressions import Names, Operation, formula_in
from rigidfluid.core.scene.exchange_tables import SinkTable
from rigidfluid.core.scene.validation import LARGEST
from rigidfluid.core.seeding.regions import Region, region_of
from rigidfluid.core.setup.changeable import staying_bodies
from rigidfluid.core.setup.model import Model
from rigidfluid.errors import SceneError

_SINGLE = ("speed", "age", "t", "radius", "volume", "mass")
"""Names in rules that are not components of a vector."""


def sink_regions(model: Model) -> SinkRegions:
    """Regions of the sinks of a model, None for one without; raises SceneError for one that is wrong."""
    return tuple(
        None if sink.region is None else region_of(sink.region, model.domain, f"sink.{number}.region", model.registry)
        for number, sink in enumerate(model.sink_tables)
    )


def leaving_bodies(now: Moment) -> list[int]:
    """Rows of free bodies that are to leave, but none that a joint, a spring or a mechanism holds, and all but one if
    nobody else is there; raises SceneError for a rule without a finite value."""
    if not now.model.sink_tables:
        return []
    system, rows = now.system, np.flatnonzero(~now.system.prescribed & _come_to_a_sink(now)).tolist()
    staying = staying_bodies(now.model) if rows else ()
    leaving = [row for row in rows if system.surfaces[row] not in staying]
    return leaving[: len(system.bodies) - 1]


@cache
def rule(source: str, at: str, dimension: int) -> Operation:
    """Function of the names of `rule_values` by a ``source`` under the key ``at``; raises SceneError where it is no
    formula of these."""
    return formula_in(source, at, _names(dimension))


def rule_values(now: Moment) -> Names:
    """State of all bodies by the names in rules, (n,) each."""
    system, twist = now.system, now.state.twist
    names = system.surfaces[: len(system.bodies)]
    since = np.array([now.population.since.get(name, 0.0) for name in names])
    speed, time = np.linalg.norm(twist.velocity, axis=1), np.full(len(names), now.time)
    single = (speed, time - since, time, system.bounding_radii, system.volumes, system.mass)
    vectors = (_centres(now), twist.velocity, twist.angular_velocity)
    columns = [column for vector in vectors for column in vector.T]
    return dict(zip(_names(system.dimension), (*columns, *single), strict=True))


def _names(dimension: int) -> tuple[str, ...]:
    """Names in rules, first those of the components of place, velocity and angular velocity."""
    axes = "xyz"[:dimension]
    turning = ("w",) if dimension == 2 else ("wx", "wy", "wz")
    return (*axes, *(f"v{axis}" for axis in axes), *turning, *_SINGLE)


def _come_to_a_sink(now: Moment) -> BoolArray:
    """Mask (n,) of the bodies that are at one of the sinks, and for which its rule holds."""
    sinks = now.model.sink_tables
    values = {} if all(sink.when is None for sink in sinks) else rule_values(now)
    at = [f"sink.{number}" for number in range(len(sinks))]
    found = [
        _is_there(now, sink, region) & _holds(now, sink, key, values)
        for sink, region, key in zip(sinks, now.sink_regions, at, strict=True)
    ]
    return np.asarray(np.any(found, axis=0))


def _is_there(now: Moment, sink: SinkTable, region: Region | None) -> BoolArray:
    """Mask (n,) of the bodies in the place of a sink, all if it has none."""
    centre, domain = _centres(now), now.model.domain
    if region is not None:
        return region.contains(centre)
    if sink.on is None:
        return np.ones(len(centre), dtype=bool)
    radius = now.system.bounding_radii
    distance = domain.pieces[domain.names.index(sink.on)].shape.signed_distance(centre) - radius
    return np.asarray(distance <= (radius if sink.gap is None else sink.gap))


def _holds(now: Moment, sink: SinkTable, at: str, values: Names) -> BoolArray:
    """Mask (n,) of the bodies for which the rule of a sink holds with these ``values``, all if it has none."""
    if sink.when is None:
        return np.ones(len(now.system.bodies), dtype=bool)
    found = rule(sink.when, f"{at}.when", now.model.dimension)(values)
    lost = np.flatnonzero(~now.system.prescribed & ~(np.abs(found) <= LARGEST))
    if lost.size:
        value, name = found[lost[0]], now.system.surfaces[lost[0]]
        remedy = "Write it so that it has a value there, as with max(…) or where(…)."
        raise SceneError(
            f"{at}.when", f"{value} from {sink.when!r} for body {name!r}", f"finite values, up to {LARGEST:g}", remedy
        )
    return found > 0.0


def _centres(now: Moment) -> FloatArray:
    """Centres of mass (n, d), along periods those of the images in the domain [length]."""
    return now.system.lattice.wrapped(now.state.pose.position)
