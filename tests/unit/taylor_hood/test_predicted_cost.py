"""Predicted memory and time of factors, compared with what was measured and what PARDISO counts here."""

import importlib.util
import subprocess
import sys

import pytest
from falling import SCENES, falling_disk

import rigidfluid
from rigidfluid.core.mesh.adaptation.mmg import MESHER_MEMORY
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.taylor_hood.linear_solver.predicted_cost import (
    predicted_blocks,
    predicted_factors,
    predicted_run,
    predicted_unknowns,
)

MEASURED = [  # dimension, unknowns, bytes, CPU seconds of analysis and factors
    (2, 11_627, 19_589 * 1024, 0.07),
    (2, 43_790, 79_970 * 1024, 0.29),
    (2, 158_648, 312_395 * 1024, 1.2),
    (3, 16_511, 117_399 * 1024, 0.57),
    (3, 29_974, 259_715 * 1024, 1.66),
    (3, 51_118, 511_005 * 1024, 4.04),
    (3, 89_752, 1_093_610 * 1024, 12.0),
    (3, 139_551, 1_904_503 * 1024, 28.8),
    (3, 248_705, 3_921_282 * 1024, 88.2),
]

BY_LU = ["fluid.solver=lu", "mesh.size=3.0", "mesh.size_body=0.6"]

with_pardiso = pytest.mark.skipif(importlib.util.find_spec("pypardiso") is None, reason="MKL is not installed")


@pytest.mark.parametrize(("dimension", "unknowns", "memory", "seconds"), MEASURED)
def test_the_fit_goes_through_what_was_measured(dimension, unknowns, memory, seconds):
    found = predicted_factors(unknowns, dimension)
    assert found.bytes == pytest.approx(memory, rel=0.1)
    assert found.seconds == pytest.approx(seconds, rel=0.15)


@pytest.mark.parametrize(("unknowns", "seconds"), [(51_118, 0.26), (89_752, 0.47), (139_551, 0.91), (248_705, 1.49)])
def test_blocks_grow_with_the_unknowns(unknowns, seconds):
    assert predicted_blocks(unknowns, 3).seconds == pytest.approx(seconds, rel=0.2)


@pytest.mark.parametrize(
    ("method", "dimension", "unknowns", "memory"),
    [
        ("lu", 2, 43_790, 434),
        ("lu", 2, 158_648, 858),
        ("lu", 3, 89_752, 1772),
        ("lu", 3, 248_705, 5275),
        ("schur", 2, 158_648, 595),
        ("schur", 3, 139_551, 822),
        ("schur", 3, 248_705, 1259),
    ],
)
def test_steps_on_one_mesh_take_what_they_took(method, dimension, unknowns, memory):
    """Far from contacts, where one matrix has factors, as in Stokes flow."""
    found = predicted_run(method, unknowns, dimension, inertia=False)
    assert found.memory == pytest.approx(memory * 2**20, rel=0.2)
    made = (predicted_factors if method == "lu" else predicted_blocks)(unknowns, dimension)
    assert predicted_run(method, unknowns, dimension, inertia=True).memory == found.memory + made.bytes


@pytest.mark.parametrize(
    ("method", "dimension", "unknowns", "memory"),
    [
        ("lu", 2, 1_259, 290),
        ("lu", 2, 7_838, 427),
        ("lu", 2, 9_542, 350),
        ("lu", 3, 18_005, 903),
        ("schur", 3, 61_521, 1074),
        ("schur", 3, 72_163, 1049),
        ("schur", 3, 80_630, 1144),
        ("schur", 3, 109_420, 1049),
        ("schur", 3, 174_308, 1628),
        ("schur", 3, 297_252, 2003),
        ("schur", 3, 465_534, 2956),
    ],
)
def test_whole_runs_take_what_they_took(method, dimension, unknowns, memory):
    """With contacts and new meshes, by their largest mesh; those in 3D are of the pages in docs/validation."""
    found = predicted_run(method, unknowns, dimension, inertia=True).memory + MESHER_MEMORY[dimension]
    assert found == pytest.approx(memory * 2**20, rel=0.18)


def test_a_mesher_takes_its_tables_whatever_the_mesh() -> None:
    """Measured in a process of its own: the resident memory at the most, of which the interpreter's libraries are a
    part that is known from before."""
    script = """
import sys
from pathlib import Path
import mmgpy
from rigidfluid.core.mesh.fluid_domain import fluid_domain_at
from rigidfluid.core.mesh.adaptation.first_mesh import inserted_mesh
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.run.mesh_keys import inserter_of, sizes_of
from rigidfluid.core.case.system import build_system
from rigidfluid.core.case.load import load_scene
scene = load_scene(sys.argv[1], ["mesh.size=3.0", "mesh.size_body=0.6"])
system = build_system(scene)
sizes = sizes_of(scene.mesh, system.domain)
around = fluid_domain_at(system, system.pose)
mesh = inserted_mesh(around, sizes, inserter_of(scene.mesh))

def peak():
    status = dict(line.split(":") for line in Path("/proc/self/status").read_text().splitlines())
    return 1024 * int(status["VmHWM"].split()[0])  # ru_maxrss begins with the parent's

before = peak()
remesh(mesh, around, sizes)
print(peak() - before)
"""
    command = [sys.executable, "-c", script, str(SCENES / "falling_sphere.toml")]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    assert float(run.stdout) == pytest.approx(MESHER_MEMORY[3], rel=0.15)


@pytest.mark.parametrize(
    ("dimension", "cells", "facets", "unknowns"),
    [
        (2, 2_651, 203, 11_627),
        (2, 12_775, 2_439, 53_831),
        (3, 4_754, 710, 18_005),
        (3, 19_800, 4_994, 68_483),
        (3, 57_022, 13_438, 197_918),
    ],
)
def test_facets_of_many_bodies_cost_no_unknowns(dimension, cells, facets, unknowns):
    assert predicted_unknowns(cells, facets, dimension) == pytest.approx(unknowns, rel=0.015)


@with_pardiso
@pytest.mark.parametrize(
    "scene",
    [
        falling_disk(mesh={"size": 0.2, "size_body": 0.02}),
        rigidfluid.load_scene(
            SCENES / "falling_sphere.toml", ["fluid.solver=lu", "mesh.size=3.0", "mesh.size_body=0.6"]
        ),
    ],
    ids=["2D", "3D"],
)
def test_it_is_what_pardiso_counts(scene):
    simulation = Simulation(scene)
    simulation.step()
    backend, mesh = simulation.system.backend, simulation.state.mesh
    unknowns = backend.unknowns(mesh, simulation.system.prescribed)
    assert predicted_unknowns(len(mesh.cells), len(mesh.facets), scene.dimension) == pytest.approx(unknowns, rel=0.03)
    counted = 1024.0 * sum(backend._solvers["lu"].viscous._factors._iparm[[15, 16]])
    assert predicted_factors(unknowns, scene.dimension).bytes == pytest.approx(counted, rel=0.2)
