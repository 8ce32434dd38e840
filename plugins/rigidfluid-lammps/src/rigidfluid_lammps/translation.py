"""The scene in LAMMPS' words: the commands that build bodies, walls and forces."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np

from rigidfluid.api import FloatArray, ForceLaw, SpringDashpotLaw, System, Wall, require_plane
from rigidfluid_lammps.kinds import Kinds, radii
from rigidfluid_lammps.tables import POINTS, Pair, write_table

_SKIN = 0.3
"""How far beyond a contact neighbours are kept, over the smallest radius: it decides the speed alone."""


def wall_fix(number: int, kind: int = 0) -> str:
    """Name of the fix of one wall, and of one kind of bodies where each has its own."""
    return f"wall{number}_{kind}"


def shell(law: ForceLaw | None) -> float:
    """Increase of ball radii in LAMMPS [length]: its springs begin at contact, ours at range."""
    return 0.5 * law.range if isinstance(law, SpringDashpotLaw) else 0.0


def rubs(law: ForceLaw | None) -> bool:
    """Tell whether contacts can turn bodies."""
    return isinstance(law, SpringDashpotLaw) and law.options.friction > 0.0


def ballast_type(kinds: Kinds) -> int:
    """The type of the points inside balls that are rigid bodies."""
    return len(kinds) + 1


def set_up(system: System, kinds: Kinds) -> Iterator[str]:
    """Commands before the bodies are there: a box, periodic or growing where they leave, and a type for each kind."""
    low, high = system.domain.extent
    lower, upper = _three(low, -0.5), _three(high, 0.5)
    crossed = np.any(system.lattice.vectors, axis=0).tolist()
    boundary = "".join("p" if along else "m" for along in crossed) + "p" * (3 - system.dimension)
    yield "units lj"
    yield f"dimension {system.dimension}"
    yield f"boundary {' '.join(boundary)}"
    yield "atom_style sphere"
    yield "atom_modify map array"
    yield "comm_modify vel yes"
    yield "region all block " + " ".join(f"{a:.17g} {b:.17g}" for a, b in zip(lower, upper, strict=True))
    yield f"create_box {len(kinds) + rubs(system.law)} all"


def forces(system: System, kinds: Kinds, folder: Path) -> Iterator[str]:
    """Commands once the bodies are there: contacts, weights, and the walls; tables go to ``folder``."""
    yield f"neighbor {_SKIN * radii(system).min():.17g} bin"
    yield "neigh_modify every 1 delay 0 check yes"
    yield "thermo_modify norm no lost error"
    law = system.law
    if law is None:
        yield f"pair_style zero {2.0 * radii(system).max():.17g}"
        yield "pair_coeff * *"
    elif isinstance(law, SpringDashpotLaw):
        yield from _granular(law, system.walls, len(kinds))
    else:
        yield from _tabulated(law, system, kinds, folder)
    for kind, body in enumerate(kinds.first, 1):
        if system.weight[body].any():
            yield f"group kind{kind} type {kind}"
            weight = " ".join(f"{part:.17g}" for part in _three(system.weight[body], 0.0))
            yield f"fix weight{kind} kind{kind} addforce {weight}"


def motion(system: System, kinds: Kinds, bodies_file: Path | None) -> Iterator[str]:
    """Commands that let the free bodies move, and hold the others.

    Without friction spins are constant and need no inertia. With friction each ball is a rigid body with the inertia
    that ``bodies_file`` holds, since LAMMPS would take that of the enlarged ball; it refuses rigid bodies of one
    particle, so each has a point without force inside it, its ballast.
    """
    held = np.flatnonzero(system.prescribed) + 1
    if len(held):
        yield f"group held id {' '.join(map(str, held))}"
        yield "group free subtract all held"
        # so that LAMMPS takes the free body's mass for that of the pair
        yield "fix hold held freeze"
    else:
        yield "group free union all"
    if len(held) == len(system.bodies):
        return
    if bodies_file is None:
        yield f"fix move free nve/sphere{' disc' if system.dimension == 2 else ''}"
    else:
        count, ballast = len(system.bodies), ballast_type(kinds)
        yield f"group ballast type {ballast}"
        yield "neigh_modify exclude group ballast all"
        yield f"variable number atom id-{count}*(type=={ballast})"
        yield f"fix move free rigid custom v_number infile {bodies_file}"
    if system.dimension == 2:
        yield "fix flat all enforce2d"


def write_bodies(path: Path, system: System) -> None:
    """Mass, inertia and motion of each free body, for ``fix rigid``."""
    free = np.flatnonzero(~system.prescribed)
    rows = [str(len(free))]
    for i in free:
        inertia = float(system.inertia[i, 0, 0])
        spin = _three(system.twist.angular_velocity[i], 0.0)
        if system.dimension == 2:
            spin = np.array([0.0, 0.0, system.twist.angular_velocity[i, 0]])
        numbers = [
            system.mass[i],
            *_three(system.pose.position[i], 0.0),
            *([inertia] * 3),
            *([0.0] * 3),
            *_three(system.twist.velocity[i], 0.0),
            *(inertia * spin),
        ]
        rows.append(f"{i + 1} " + " ".join(f"{number:.17g}" for number in numbers) + " 0 0 0")
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def _granular(law: SpringDashpotLaw, walls: tuple[Wall, ...], kind_count: int) -> Iterator[str]:
    model = _contact_model(law)
    yield "pair_style granular"
    yield f"pair_coeff * * {model}"
    yield f"group balls type <= {kind_count}"
    for number, wall in enumerate(walls):
        axis, place, side = _plane(wall)
        place += side * shell(law)
        sides = f"{place:.17g} NULL" if side > 0 else f"NULL {place:.17g}"
        yield f"fix {wall_fix(number)} balls wall/gran granular {model} {'xyz'[axis]}plane {sides} contacts"


def _contact_model(law: SpringDashpotLaw) -> str:
    options = law.options
    if options.restitution is None:
        normal = f"hooke {options.stiffness:.17g} {options.damping or 0.0:.17g} damping velocity"
    else:
        normal = f"hooke {options.stiffness:.17g} {options.restitution:.17g} damping coeff_restitution"
    history = "nohistory" if options.tangential_stiffness is None else f"history {options.tangential_stiffness:.17g}"
    return f"{normal} tangential linear_{history} {options.tangential_damping:.17g} {options.friction:.17g}"


def _tabulated(law: ForceLaw, system: System, kinds: Kinds, folder: Path) -> Iterator[str]:
    radius = radii(system)
    yield f"pair_style table spline {POINTS}"
    for one, other in combinations_with_replacement(range(len(kinds)), 2):
        a, b = int(kinds.first[one]), int(kinds.first[other])
        path = folder / f"pair{one}_{other}"
        cutoff = write_table(path, law, Pair((a, b), (radius[a], radius[b])))
        yield f"pair_coeff {one + 1} {other + 1} {path} LAW {cutoff:.17g}"
    for kind, body in enumerate(kinds.first, 1):
        yield f"group kind{kind} type {kind}"
        path = folder / f"wall{kind}"
        if system.walls:
            meeting = Pair((int(body), system.walls[0].surface), (radius[body], np.inf), at_wall=True)
            cutoff = write_table(path, law, meeting)
        for number, wall in enumerate(system.walls):
            axis, place, towards = _plane(wall)
            side = f"{'xyz'[axis]}{'lo' if towards > 0 else 'hi'} {place:.17g}"
            name = wall_fix(number, kind)
            yield f"fix {name} kind{kind} wall/table spline {POINTS} {side} {path} LAW {cutoff:.17g}"
            yield f"fix_modify {name} energy yes"


def _plane(wall: Wall) -> tuple[int, float, float]:
    """The axis across it, its place there, and the sign of its normal."""
    plane = require_plane(wall, "lammps")
    assert plane.axis is not None
    return plane.axis, float(plane.point[plane.axis]), float(plane.unit_normal[plane.axis])


def _three(vector: FloatArray, last: float) -> FloatArray:
    """A vector with a third component, in 2D ``last``."""
    return np.append(vector, [last] * (3 - len(vector)))
