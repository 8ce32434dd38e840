"""The scene as LAMMPS runs it."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from rigidfluid.api import FloatArray, IntArray, Pose, SpringDashpotLaw, System, require_plane
from rigidfluid_lammps.kinds import Kinds, kinds, radii
from rigidfluid_lammps.library import lammps_session
from rigidfluid_lammps.samples import Sample, Samples
from rigidfluid_lammps.timing import Timing
from rigidfluid_lammps.translation import (
    ballast_type,
    forces,
    motion,
    rubs,
    set_up,
    shell,
    wall_fix,
    write_bodies,
)

_GLOBAL, _PER_ATOM = 0, 1
_VECTOR, _ARRAY = 1, 2


def run_theirs(system: System, timing: Timing) -> Samples:
    """Run balls without a fluid in LAMMPS, one ``run`` for each block; samples at the start and at block ends.

    Raises CrosscheckError if LAMMPS is missing or fails.
    """
    sorts = kinds(system)
    with TemporaryDirectory(prefix="rigidfluid-") as name, lammps_session() as engine:
        build(engine, system, sorts, Path(name))
        engine.command(f"timestep {timing.step!r}")
        engine.command("run 0")
        samples = [_sample(engine, system, sorts)]
        for _ in range(timing.blocks):
            engine.command(f"run {timing.steps}")
            samples.append(_sample(engine, system, sorts))
    return Samples.stack(timing.times, samples)


def build(engine: Any, system: System, sorts: Kinds, folder: Path) -> None:
    """Tell an instance of LAMMPS of the bodies, walls and forces; tables go to ``folder``."""
    engine.commands_list(list(set_up(system, sorts)))
    _create_bodies(engine, system, sorts)
    engine.commands_list(list(forces(system, sorts, folder)))
    bodies_file = folder / "bodies" if rubs(system.law) else None
    if bodies_file is not None:
        write_bodies(bodies_file, system)
    engine.commands_list(list(motion(system, sorts, bodies_file)))


def _create_bodies(engine: Any, system: System, sorts: Kinds) -> None:
    """Balls, numbered from 1 on as bodies are, and then their ballast where they are rigid bodies."""
    count, d = system.pose.position.shape
    ballast = np.flatnonzero(~system.prescribed) if rubs(system.law) else np.zeros(0, dtype=np.int64)
    bodies = np.concatenate([np.arange(count), ballast])
    numbers = np.concatenate([np.arange(count), count + ballast]) + 1
    types = np.concatenate([sorts.number, np.full(len(ballast), ballast_type(sorts))])
    size = np.concatenate([radii(system) + shell(system.law), np.zeros(len(ballast))])
    position, velocity, spin = np.zeros((3, len(bodies), 3))
    position[:, :d], velocity[:, :d] = system.pose.position[bodies], system.twist.velocity[bodies]
    position[count:, 0] += 0.5 * radii(system)[ballast]
    cells = _cells(system, position)
    position -= cells * _lengths(system)
    spin[:, 3 - system.twist.angular_velocity.shape[1] :] = system.twist.angular_velocity[bodies]
    columns = (column.ravel().tolist() for column in (position, velocity))
    images = [engine.encode_image_flags(*cell) for cell in cells.tolist()]
    engine.create_atoms(len(bodies), numbers.tolist(), types.tolist(), *columns, images)
    here = np.argsort(np.argsort(engine.numpy.extract_atom("id")[: len(bodies)]))
    engine.numpy.extract_atom("radius")[: len(bodies)] = size[here]
    engine.numpy.extract_atom("rmass")[: len(bodies)] = system.mass[bodies[here]]
    engine.numpy.extract_atom("omega")[: len(bodies)] = spin[here]


def _sample(engine: Any, system: System, sorts: Kinds) -> Sample:
    count, d = system.pose.position.shape
    here = engine.extract_global("nlocal")
    order = np.argsort(engine.numpy.extract_atom("id")[:here])[:count]
    position, velocity, spin = (engine.numpy.extract_atom(name)[order] for name in ("x", "v", "omega"))
    images = engine.numpy.extract_atom("image")[order]
    position = position + [engine.decode_image_flags(int(image)) for image in images] * _lengths(system)
    spin = spin[:, 3 - system.twist.angular_velocity.shape[1] :]
    normals = [require_plane(wall, "lammps").unit_normal for wall in system.walls]
    if isinstance(system.law, SpringDashpotLaw):
        stored = _spring_energy(system, system.law, position[:, :d])
        pushed = [_granular_push(engine, number, normal) for number, normal in enumerate(normals)]
    else:
        stored = float(engine.get_thermo("pe"))
        pushed = [_table_push(engine, number, normal, sorts) for number, normal in enumerate(normals)]
    return Sample(position[:, :d], velocity[:, :d], spin, stored, np.array(pushed))


def _lengths(system: System) -> FloatArray:
    """Distances of periodic surfaces along each axis, zero where there are none, (3,) [length]."""
    lengths = np.abs(system.lattice.vectors).sum(axis=0)
    return np.append(lengths, np.zeros(3 - len(lengths)))


def _cells(system: System, position: FloatArray) -> IntArray:
    """Images of the domain along each axis that points (N, 3) are in, (N, 3)."""
    cells, d = np.zeros(position.shape, dtype=np.int64), system.dimension
    crossed = np.flatnonzero(system.lattice.vectors.any(axis=0))
    low, high = system.domain.extent
    cells[:, crossed] = np.floor((position[:, :d] - low) / (high - low))[:, crossed].astype(np.int64)
    return cells


def _spring_energy(system: System, law: SpringDashpotLaw, position: FloatArray) -> float:
    """Energy of the springs at LAMMPS' positions [energy]: it does not sum that of granular contacts itself."""
    contacts = system.detection.detect(Pose(position, system.pose.orientation), None, law.range)
    return float(np.sum(law.energy(contacts)))


def _granular_push(engine: Any, wall: int, normal: FloatArray) -> float:
    """How hard the bodies push a wall outwards; the columns 1 to 3 are the force on each body [force]."""
    on_bodies = engine.numpy.extract_fix(wall_fix(wall), _PER_ATOM, _ARRAY)
    return float((on_bodies[:, 1 : 1 + len(normal)] @ normal).sum())


def _table_push(engine: Any, wall: int, normal: FloatArray, sorts: Kinds) -> float:
    if not engine.has_id("fix", wall_fix(wall, 1)):
        return 0.0
    on_wall = sum(engine.extract_fix(wall_fix(wall, kind), _GLOBAL, _VECTOR, 0) for kind in range(1, len(sorts) + 1))
    return -float(normal.sum() * on_wall)
