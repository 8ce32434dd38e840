"""`mpirun rigidfluid run`, in processes of their own, with a backend in which the root does all the work.

Where DOLFINx is installed its backend, which shares the work, makes the same run.
"""

import csv
import json
import os
import shutil
import signal
import time
from importlib.util import find_spec

import numpy as np
import pytest
from falling import SCENES

from rigidfluid.core.output.vtu import read_pvd, read_vtu
from rigidfluid.registry import FLUID_BACKEND, Registry

pytestmark = [
    pytest.mark.skipif(find_spec("mpi4py") is None, reason="mpi4py is not installed"),
    pytest.mark.skipif(shutil.which("mpirun") is None, reason="there is no mpirun"),
]

SETTINGS = {
    "fluid.backend": '"gathered"',
    "mesh.size": 0.3,
    "mesh.size_body": 0.05,
    "time.step": 0.004,
    "time.end": 0.056,
    "output.every": 0.02,
    "body.0.position": [1.0, 0.24],
    "body.0.velocity": [0.0, -2.0],
    "contact.detector": '"narrow_band"',
}
"""A disk that nears the floor; its mesh is regenerated on the way."""

BOUNCE = {
    "fluid__viscosity": 0.01,
    "fluid__tolerance": 1e-11,
    "body__0__position": [1.0, 0.2],
    "body__0__velocity": [0.0, -10.0],
    "body__0__density": 8.0,
    "contact__detector": '"sphere"',
    "contact__range": 0.05,
    "contact__epsilon_wall": 1e-7,
    "time__step": 0.001,
    "time__end": 0.012,
    "output__every": 0.001,
}
"""A heavy disk that the floor throws back."""


def fall(out, *options, **settings):
    chosen = SETTINGS | {key.replace("__", "."): value for key, value in settings.items()}
    words = [word for key, value in chosen.items() for word in ("--set", f"{key}={value}")]
    return ["-m", "rigidfluid", "run", SCENES / "falling_disk.toml", "--out", out, *options, *words]


def table(path):
    """The numbers of a table, by column."""
    rows = list(csv.DictReader(path.read_text().splitlines()))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0] if name != "body"}


def installed(backend):
    entries = [entry for entry in Registry.load().entries if entry.kind is FLUID_BACKEND and entry.name == backend]
    return any(entry.available for entry in entries)


def succeeded(result):
    assert result.returncode == 0, result.stderr
    return result


VECTORS = [("fx", "fy"), ("cfx", "cfy"), ("vx", "vy")]
"""Columns held against the whole vector: a path found by trial solves its first trial to five digits."""


def assert_same_tables(folders, names, rtol):
    for name in names:
        expected, found = (table(folder / name) for folder in folders)
        for column, values in expected.items():
            whole = next((vector for vector in VECTORS if column in vector), ())
            atol = max([1e-8, *(rtol * np.abs(expected[entry]).max() for entry in whole)])
            if column.startswith("residual"):  # small differences of energies, with the round-off of those
                atol = max(atol, 1e-7 * expected["kinetic"].max())
            np.testing.assert_allclose(found[column], values, rtol=rtol, atol=atol, err_msg=f"{name} {column}")


@pytest.fixture(params=["gathered", "dolfinx"])
def backend(request):
    if request.param == "dolfinx" and not installed("dolfinx"):
        pytest.skip("DOLFINx is not installed")
    return request.param


def test_two_processes_run_as_one_does_with_a_stop_in_between(mpirun, tmp_path, backend):
    chosen = {"fluid__backend": f'"{backend}"'}
    succeeded(mpirun(1, *fall(tmp_path / "one", **chosen)))
    succeeded(mpirun(2, *fall(tmp_path / "two", time__end=0.02, **chosen)))
    said = succeeded(mpirun(2, *fall(tmp_path / "two", "--resume", **chosen))).stdout
    assert said.count("wrote to") == 1
    one, two = (json.loads((tmp_path / name / "summary.json").read_text()) for name in ("one", "two"))
    assert (one["ranks"], two["ranks"]) == (1, 2)
    assert two["remeshes"] > 0
    for figure in ("status", "cells", "unknowns", "steps", "remeshes", "rejected_steps"):
        assert one[figure] == two[figure]
    assert_same_tables([tmp_path / "one", tmp_path / "two"], ("bodies.csv", "energy.csv"), rtol=1e-7)
    last = [read_vtu(read_pvd(tmp_path / name / "fields.pvd")[-1][1]) for name in ("one", "two")]
    assert len(last[0].points) == len(last[1].points)
    assert (tmp_path / "two" / "state.1.h5").exists()


def test_two_processes_see_the_impact_that_one_does(mpirun, tmp_path, backend):
    """In a fluid, where what a contact gives follows from the impulse responses, on all processes alike."""
    folders = [tmp_path / "one", tmp_path / "two"]
    for count, folder in enumerate(folders, start=1):
        succeeded(mpirun(count, *fall(folder, fluid__backend=f'"{backend}"', **BOUNCE)))
    speed, pushed = (table(folders[0] / "bodies.csv")[name] for name in ("vy", "cfy"))
    assert speed.min() < -8.0
    assert speed[-1] > 5.0
    assert pushed.max() > 100.0 * pushed[-1] >= 0.0
    assert_same_tables(folders, ("bodies.csv", "energy.csv"), rtol=3e-6)


def test_a_run_goes_on_with_other_numbers_of_processes(mpirun, tmp_path, backend):
    """From one to two, from two to three, and back to one: new meshes before and after."""
    chosen = {"fluid__backend": f'"{backend}"'}
    succeeded(mpirun(1, *fall(tmp_path / "one", **chosen)))
    succeeded(mpirun(1, *fall(tmp_path / "more", time__end=0.02, **chosen)))
    for count, end in ((2, 0.032), (3, 0.044), (1, 0.056)):
        succeeded(mpirun(count, *fall(tmp_path / "more", "--resume", **chosen | {"time__end": end})))
    one, more = (json.loads((tmp_path / name / "summary.json").read_text()) for name in ("one", "more"))
    assert more["ranks"] == 1
    for figure in ("status", "cells", "unknowns", "steps", "remeshes", "rejected_steps"):
        assert one[figure] == more[figure]
    assert_same_tables([tmp_path / "one", tmp_path / "more"], ("bodies.csv", "energy.csv"), rtol=1e-7)
    assert [path.name for path in (tmp_path / "more").glob("state*")] == ["state.h5"]
    assert all(len(read_vtu(path).cells) for _, path in read_pvd(tmp_path / "more" / "fields.pvd"))


def test_a_backend_of_one_process_is_refused_once(mpirun, tmp_path):
    result = mpirun(2, *fall(tmp_path / "out", fluid__backend='"scikit-fem"'))
    assert result.returncode != 0
    assert result.stderr.count("fluid.backend: found 'scikit-fem', which runs in 1, and 2 processes") == 1
    assert not (tmp_path / "out").exists()


def test_one_process_that_fails_ends_all(mpirun, tmp_path):
    result = mpirun(2, *fall(tmp_path / "out"), RIGIDFLUID_TEST_FAILING_RANK="1")
    assert result.returncode != 0
    assert result.stderr.count("Traceback") == 1
    assert "ZeroDivisionError" in result.stderr
    assert not (tmp_path / "out" / "summary.json").exists()


def test_ctrl_c_on_one_process_ends_all_with_a_summary(mpi, mpirun, tmp_path, backend):
    """A real signal, to the process that the folder's lock names; a shell in the background may ignore it."""
    chosen = {"fluid__backend": f'"{backend}"', "time__end": 0.1}
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    process = mpi(2, *fall(tmp_path, **chosen))
    signal.signal(signal.SIGINT, before)
    while not (tmp_path / "fields" / "000001.pvtu").exists() and process.poll() is None:
        time.sleep(0.02)
    os.kill(int((tmp_path / "run.lock").read_text().split()[0]), signal.SIGINT)
    _, complaint = process.communicate(timeout=900)
    assert process.returncode != 0
    assert complaint.count("Interrupted.") == 1
    assert "Traceback" not in complaint
    assert json.loads((tmp_path / "summary.json").read_text())["status"] == "interrupted"
    succeeded(mpirun(2, *fall(tmp_path, "--resume", **chosen | {"time__end": 0.04})))


FULL_DISK = """
import errno
from rigidfluid.core.output import writer

stage = writer.stage_checkpoint

def stage_where_there_is_room(path, checkpoint):
    if path.name == "state.1.h5":
        raise OSError(errno.ENOSPC, "No space left on device")
    stage(path, checkpoint)

writer.stage_checkpoint = stage_where_there_is_room
from rigidfluid.cli import app
app()
"""


def test_a_full_disk_of_one_process_is_reported_once(mpirun, tmp_path):
    assert mpirun(2, *fall(tmp_path, time__end=0.004)).returncode == 0
    _, _, *arguments = fall(tmp_path, "--resume", time__end=0.008)
    result = mpirun(2, "-c", FULL_DISK, *arguments)
    assert result.returncode != 0
    assert result.stderr.count("state.1.h5: found No space left") == 1
