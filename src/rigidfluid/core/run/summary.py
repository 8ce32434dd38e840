"""The summary of a run: the figures that matter, and what they cost."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from dataclasses import asdict
from importlib import metadata
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from rigidfluid.core.contact.laws.strength import chosen_strengths
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.energy import Ledger
from rigidfluid.core.model.ranks import Ranks
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.output.energy_account import EnergyAccount, energy_account, energy_warnings
from rigidfluid.core.output.energy_flows import Table
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import LEDGER_COLUMNS, count_cells
from rigidfluid.core.output.verdict import verdict
from rigidfluid.core.run.cycles import cycles, start_remarks
from rigidfluid.core.run.exchange_account import exchange_account
from rigidfluid.core.run.process import peak_memory
from rigidfluid.core.run.remarks import layer_remarks, sensitivity_remarks, source_remarks
from rigidfluid.core.run.remesh_jumps import jump_remarks, remesh_jumps
from rigidfluid.core.run.turn_remarks import turn_remarks
from rigidfluid.core.setup.model import Model

if TYPE_CHECKING:
    from rigidfluid.core.run.simulation import Simulation

_PACKAGES = (
    *("rigidfluid", "numpy", "scipy", "numba", "scikit-fem", "pypardiso", "netgen-mesher", "mmgpy", "h5py"),
    *("fenics-dolfinx", "petsc4py", "mpi4py", "ngsolve"),
)
FIGURES = (
    *("time", "unknowns", "cells", "worst_quality", "ranks", "steps", "rejected_steps", "unsettled_steps", "remeshes"),
    *("failed_remeshes", "wall_time", "cpu_time", "wall_time_per_stage"),
    *("reynolds_solid_density", "reynolds", "smallest_gap", "rest_position", "cycles", "remesh_jumps", "energy"),
    *("mesh_error", "error_estimates", "exchanges"),
)
"""Keys of summary.json that hold numbers of a run, or tables and lists of them."""
ACCOUNT = ("at_hand", "round_off", "put_in", "created", "lost", "unaccounted", "grad_div")
FLOWS = ("largest_creation", "summed_creation", "largest_loss", "summed_loss")
ENERGIES = (*LEDGER_COLUMNS, "relative_residual", *ACCOUNT, *FLOWS)
"""Keys of its table ``energy`` that hold numbers."""


def summarise(simulation: Simulation, status: str) -> dict[str, Any]:
    """All of summary.json but the list of files."""
    account = energy_account(simulation.history.energy)
    state, system, extremes = simulation.state, simulation.system, simulation.recorder.extremes
    mesh, found, problem = simulation.model.fluid.mesh, _cycles(simulation), system.fluid
    radii = {name: body.bounding_radius for name, body in zip(system.surfaces, system.bodies, strict=False)}
    length = max(radii.values(), default=0.0)
    remarks = layer_remarks(system, extremes.highest_speed, None if mesh is None else mesh.size_body)
    remarks += source_remarks(simulation.model, simulation.population, simulation.time)
    remarks += sensitivity_remarks(simulation.sensitivities_ended, simulation.history)
    inertia = problem is not None and problem.inertia
    remarks += start_remarks(found.get("cycles", {}), inertia, length)
    jumps = remesh_jumps(simulation.history, radii) if simulation.counts.remeshes else {}
    remarks += jump_remarks(jumps)
    if inertia:
        remarks += turn_remarks(simulation.history, account)
    return {
        "status": status,
        "scene": simulation.model.document,
        "seed": simulation.model.seed,
        "versions": versions(),
        "time": simulation.clock.time(state.tick),
        "unknowns": system.backend.unknowns(state.mesh, system.motions.prescribed),
        "cells": count_cells(state.mesh),
        "worst_quality": _finite(np.min(simulation.history.steps["quality"], initial=np.inf)),
        "ranks": system.backend.ranks.size,
        "steps": state.count,
        "rejected_steps": simulation.counts.rejected,
        "unsettled_steps": simulation.counts.unsettled,
        "remeshes": simulation.counts.remeshes,
        "failed_remeshes": simulation.counts.failed_remeshes,
        "latest_failed_remesh": simulation.counts.latest_failed_remesh,
        "wall_time": simulation.elapsed,
        "cpu_time": simulation.cpu_time,
        "wall_time_per_stage": simulation.watch.seconds,
        "peak_memory": _total_memory(system.backend.ranks, peak_memory()),
        **reynolds_numbers(simulation.model, system, extremes.highest_speed),
        "smallest_gap": _finite(extremes.smallest_gap),
        "rest_position": {system.surfaces[i]: position for i, position in enumerate(state.pose.position.tolist())},
        **found,
        **_caller_values(state, system),
        **({"population": simulation.population.changes} if simulation.population else {}),
        **exchange_account(simulation),
        **_mesh_errors(simulation.history),
        "remesh_jumps": jumps,
        **_error_figures(simulation),
        "remarks": [asdict(remark) for remark in remarks],
        "energy": energy_balance(state.ledger, simulation.history.energy, account),
        "auto_epsilon": chosen_strengths(system),
    }


def _cycles(simulation: Simulation) -> dict[str, Any]:
    """Cycles of the mechanisms whose strokes repeat; empty without any."""
    periods = {name: mechanism.period for name, mechanism in simulation.model.mechanisms_by_name.items()}
    repeated = {name: period for name, period in periods.items() if period is not None}
    return {"cycles": cycles(simulation.history, repeated)} if repeated else {}


def _mesh_errors(history: History) -> dict[str, Any]:
    """Latest and largest relative error of the mesh; empty where it was not estimated."""
    found = history.table("mesh_error", only=["relative"])["relative"]
    return {"mesh_error": {"latest": _finite(found[-1]), "largest": _finite(found.max())}} if len(found) else {}


def _error_figures(simulation: Simulation) -> dict[str, Any]:
    """Error bars, if the run has any."""
    if not simulation.model.output.error_bars:
        return {}
    from rigidfluid.core.output.error_figures import error_figures  # few runs want them

    return {"error_estimates": error_figures(simulation.history.error_estimates, simulation.model.dimension)}


def _caller_values(state: State, system: System) -> dict[str, Any]:
    """Velocities and forces that the caller has prescribed and applied last, each with the angular ones after them, by
    name; empty without any."""
    by_hand = {}
    if state.prescription is not None:
        by_hand["prescribed"] = _rows(system, state.prescription.twist, system.prescribed)
    if state.applied is not None:
        by_hand["applied"] = _rows(system, flat(state.applied), np.any(flat(state.applied), axis=1))
    return {"by_hand": by_hand} if by_hand else {}


def _rows(system: System, rows: FloatArray, chosen: ArrayLike) -> dict[str, list[float]]:
    """Rows of the chosen bodies, by name."""
    return {system.surfaces[i]: rows[i].tolist() for i in np.flatnonzero(chosen)}


def _total_memory(ranks: Ranks, memory: int | None) -> int | None:
    """Sum of the processes' memory [byte]; None unless each knows its own."""
    each = [part for part in ranks.allgather(memory) if part is not None]
    return sum(each) if len(each) == ranks.size else None


def _finite(value: float) -> float | None:
    """The number, or None where it is infinite: JSON knows no infinity."""
    return float(value) if np.isfinite(value) else None


def reynolds_numbers(model: Model, system: System, speeds: FloatArray) -> dict[str, float | None]:
    """Highest Reynolds number 2 R ρ |v| / μ of any body, with the solid's density and with the fluid's.

    ``speeds`` (n,) are the highest |v|, and μ is that of the shear rate |v|/2R. R is the radius of a
    ball, of other shapes that of the smallest ball around them. None without a fluid, or bodies.
    """
    fluid = system.fluid
    if fluid is None or not system.bodies:
        return {"reynolds_solid_density": None, "reynolds": None}
    diameters = 2.0 * system.bounding_radii
    per_density = diameters * speeds / fluid.material.viscosity(speeds / diameters)
    solid = np.array([body.density for body in model.all_bodies])
    return {
        "reynolds_solid_density": float(np.max(per_density * solid)),
        "reynolds": float(np.max(per_density) * fluid.density),
    }


def energy_balance(ledger: Ledger, energy: Table, account: EnergyAccount) -> dict[str, Any]:
    """Energy stored, that came in and that went out [energy], the shares of it that came from nowhere or vanished, and
    the ``warnings`` of that; by the ledger at the end, the table of ``energy`` over time and its ``account``."""
    stored = {name: getattr(ledger, name) for name in (*LEDGER_COLUMNS, "relative_residual")}
    shares = {name: getattr(account, name) for name in ACCOUNT} | _flows(account, energy["time"])
    return stored | shares | {"warnings": [asdict(warning) for warning in energy_warnings(energy, account)]}


def _flows(account: EnergyAccount, time: FloatArray) -> dict[str, Any]:
    """Largest and summed creation and loss over what was at hand, when the largest was, and sums by cause [energy]."""
    found: dict[str, Any] = {}
    for name, flow in (("creation", account.creation), ("loss", account.loss)):
        found |= {f"largest_{name}": account.share(flow.largest), f"summed_{name}": account.share(flow.summed)}
        found[f"{name}_between"] = [float(time[flow.start]), float(time[flow.end])]
        found[f"{name}_by_cause"] = flow.by_cause
    return found


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that decide the results, where installed."""
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return found


def warnings_of(summary: Mapping[str, Any]) -> list[str]:
    """All that a run warns of at its end, each with its remedy."""
    texts = [text for grade, text in verdict(summary) if grade.endswith("warning")]
    if count := summary["failed_remeshes"]:
        latest = summary["latest_failed_remesh"]
        texts.append(f"a new mesh could not be made {count} times; the one before served on. The latest: {latest}")
    return texts
