"""From the table of a swarm to tables of bodies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Pose
from rigidfluid.core.nested.placing import check_orientation
from rigidfluid.core.scene.swarm_tables import SeededTable, SizeTable, SwarmTable, TableSizes, UniformSizes
from rigidfluid.core.seeding.clearance import Surroundings
from rigidfluid.core.seeding.draws import Draws, share_between_ends
from rigidfluid.core.seeding.listed_bodies import Row, columns, listed_bodies
from rigidfluid.core.seeding.placement import Others, Placement, nearest, refuse_outside
from rigidfluid.core.seeding.regions import DomainRegion, Region, region_of
from rigidfluid.core.seeding.swarm import Swarm, swarm_of, with_fraction, with_rows
from rigidfluid.errors import SceneError
from rigidfluid.registry import Registry

LEAST_SHARE = 1e-6
"""Least share of a distribution of sizes between its ends: of a smaller one numbers know little."""


@dataclass(frozen=True)
class Seeded:
    """Seeded bodies: their ``tables`` as of the scene's bodies, the ``record`` of the swarm, and all ``bodies`` that
    are there then."""

    tables: tuple[dict[str, Any], ...]
    record: SeededTable
    bodies: Others


@dataclass(frozen=True)
class Occupied:
    """A ``domain`` with the ``others`` that are in it before a swarm, and the parts that are installed; bodies may lie
    across periodic surfaces by the vectors of the ``lattice``."""

    domain: Domain
    others: Others
    lattice: Lattice
    registry: Registry


def seed(table: SwarmTable, at: str, draws: Draws, occupied: Occupied, grow: bool = True) -> Seeded:
    """Bodies of a swarm in a domain among others, dense ones by growth if they may ``grow``; raises SceneError or
    PluginError for what is wrong with its table, and where there is not enough room."""
    domain, others, registry = occupied.domain, occupied.others, occupied.registry
    _check_table(table, at, domain.dimension)
    whole, region = DomainRegion(domain), region_of(table.region, domain, f"{at}.region", registry)
    if table.region is not None:
        refuse_outside(region, whole, f"{at}.region", draws)
    swarm, rows = swarm_of(table, at, domain.dimension, draws, registry), []
    if table.file is not None:
        rows = listed_bodies(table.file, f"{at}.file", domain.dimension)
        swarm = with_rows(swarm, rows)
    elif table.fraction is not None:
        swarm = with_fraction(swarm, table.fraction, region.volume)
    else:
        assert table.number is not None
        swarm = swarm.first(table.number)
    surroundings = _surroundings(swarm, region, occupied)
    orientation, turning = _orientations(swarm, draws)
    way: Literal["insertion", "growth", "file"] = "file"
    if rows:
        pose = _listed(rows, columns(swarm.dimension)[:2], orientation)
    else:
        pose, way = Placement(swarm, region, surroundings, others, draws, grow).placed(orientation, turning)
        pose = Pose(surroundings.lattice.wrapped(pose.position), pose.orientation)
    gap, body = nearest(swarm.bodies, pose, others, surroundings, 2.0 * swarm.gap)
    if rows and not gap > 0.0:
        raise _overlap(f"{at}.file, line {rows[body]['line']}", pose.position[body], gap)
    record = SeededTable(number=len(swarm), fraction=swarm.volume / region.volume, gap=gap, way=way)
    return Seeded(tuple(_tables(swarm, pose, rows, draws)), record, others.joined(swarm.bodies, pose))


def _surroundings(swarm: Swarm, region: Region, occupied: Occupied) -> Surroundings:
    """The surroundings of a swarm: images where all bodies are shorter than the periods, else periodic surfaces. A
    region holds all of each body, and so keeps it off these."""
    domain, lattice = occupied.domain, occupied.lattice
    longest = max(body.bounding_radius for body in (*swarm.bodies, *occupied.others.bodies))
    if 2.0 * longest + swarm.gap >= lattice.shortest:
        lattice = domain.alone
    if swarm.table.region is not None:
        return Surroundings(domain.pieces, tuple(region.surfaces), lattice, occupied.registry)
    crossed = domain.periodic_pieces if len(lattice.vectors) else frozenset()
    pieces = tuple(piece for number, piece in enumerate(domain.pieces) if number not in crossed)
    return Surroundings(pieces, (), lattice, occupied.registry)


def _overlap(at: str, place: FloatArray, gap: float) -> SceneError:
    """Error for a listed body that overlaps another one or a wall."""
    found = f"a body at {place.tolist()} with a gap of {gap:.6g} to another one or to a wall"
    remedy = f"Move it by more than {-gap:.6g}, or make it smaller."
    return SceneError(at, found, "bodies inside the domain and clear of all others", remedy)


def _check_table(table: SwarmTable, at: str, dimension: int) -> None:
    check_orientation(table, dimension, at)
    given = [key for key in ("number", "fraction", "file") if getattr(table, key) is not None]
    if len(given) != 1:
        found = " and ".join(given) or "none of number, fraction and file"
        remedy = f"Leave {given[-1]} out." if given else "Say how many bodies there are."
        raise SceneError(f"{at}.{given[-1] if given else 'number'}", found, "one of number, fraction and file", remedy)
    if table.file is not None and (placed := [key for key in ("region", "gap") if getattr(table, key) is not None]):
        remedy = "Leave it out: the file says where bodies are."
        raise SceneError(f"{at}.{placed[0]}", f"{placed[0]} together with file", "one of them", remedy)
    if table.tilt and table.angle is None and table.orientation is None:
        key = "angle" if dimension == 2 else "orientation"
        remedy = f"Give {key}, or leave tilt out: then all orientations are equally likely."
        raise SceneError(f"{at}.tilt", f"{table.tilt:g} from no {key}", f"tilt from an {key}", remedy)
    if table.size is not None:
        _check_sizes(table.size, f"{at}.size")


def _check_sizes(size: SizeTable, at: str) -> None:
    if isinstance(size, TableSizes):
        if not any(share for _, share in size.rows):
            raise SceneError(f"{at}.rows", "shares of 0", "a share above 0 in a row", "Correct them.")
        return
    if not size.least <= size.greatest:
        allowed = f"at least size.least = {size.least:g}"
        raise SceneError(f"{at}.greatest", size.greatest, allowed, "Swap or correct them.")
    if not isinstance(size, UniformSizes) and size.least < size.greatest and share_between_ends(size) < LEAST_SHARE:
        found = f"{size.least:g}, up to size.greatest = {size.greatest:g}, with less than {LEAST_SHARE:g} of all sizes"
        remedy = "Correct them, or the middle or `deviation` of the distribution."
        raise SceneError(f"{at}.least", found, "ends with sizes between them", remedy)


def _orientations(swarm: Swarm, draws: Draws) -> tuple[FloatArray, bool]:
    """Orientations (n, q), and whether bodies may rotate to find room: not where they are given, nor balls."""
    table, dimension = swarm.table, swarm.dimension
    if table.angle is None and table.orientation is None:
        round_ones = all(shape.radius is not None for shape in swarm.shapes)
        return draws.orientations(len(swarm), dimension), not round_ones
    given = np.array([table.angle] if dimension == 2 else table.orientation, dtype=float)
    given = given if dimension == 2 else given / np.linalg.norm(given)
    return draws.tilted(np.tile(given, (len(swarm), 1)), table.tilt), False


def _listed(rows: Sequence[Row], names: Sequence[Sequence[str]], orientation: FloatArray) -> Pose:
    """Pose of the ``rows`` of a file; the given ``orientation`` (n, q) without columns of it."""
    places, turns = names
    position = np.array([[row[name] for name in places] for row in rows], dtype=float)
    if turns[0] in rows[0]:
        orientation = np.array([[row[name] for name in turns] for row in rows], dtype=float)
    return Pose(position, orientation)


def _tables(swarm: Swarm, pose: Pose, rows: Sequence[Row], draws: Draws) -> Iterator[dict[str, Any]]:
    table, (_, turns, velocities, spins) = swarm.table, columns(swarm.dimension)
    velocity = _rates(table.velocity, table.velocity_deviation, len(swarm), len(velocities), draws)
    spin = _rates(table.angular_velocity, table.angular_velocity_deviation, len(swarm), len(spins), draws)
    for body in range(len(swarm)):
        row: Row = rows[body] if rows else {}
        yield {
            "name": row.get("name") or f"{table.name}{body}",
            "density": row.get("density", table.density),
            **swarm.options(body),
            "position": pose.position[body].tolist(),
            **_orientation(swarm, pose, body, turns[0] in row),
            **_rate("velocity", velocity, body, velocities, row),
            **_rate("angular_velocity", spin, body, spins, row),
        }


def _orientation(swarm: Swarm, pose: Pose, body: int, listed: bool) -> dict[str, Any]:
    """Key of an orientation, without one of balls for which none is given."""
    given = listed or swarm.table.angle is not None or swarm.table.orientation is not None
    if swarm.bodies[body].radius is not None and not given:
        return {}
    turned = pose.orientation[body].tolist()
    return {"angle": turned[0]} if swarm.dimension == 2 else {"orientation": turned}


def _rates(
    mean: Sequence[float] | None, deviation: float, count: int, components: int, draws: Draws
) -> FloatArray | None:
    """Velocities (n, d), or angular ones (n, k), None where all are zero."""
    random = deviation * draws.normal(count, components)
    if mean is None and deviation == 0.0:
        return None
    return random if mean is None else random + mean


def _rate(key: str, drawn: FloatArray | None, body: int, names: Sequence[str], row: Row) -> dict[str, Any]:
    if names[0] in row:
        return {key: [row[name] for name in names]}
    return {} if drawn is None else {key: drawn[body].tolist()}
