"""A run that is killed and resumed equals an uninterrupted one to the last bit."""

import json
import random
import subprocess
import sys
import time

import pytest
from falling import SCENES

import rigidfluid
from rigidfluid.core.case.load import load_scene
from rigidfluid.core.output.checkpoint import read_checkpoint

pytestmark = pytest.mark.long

COMMAND = [sys.executable, "-m", "rigidfluid", "run", str(SCENES / "falling_disk.toml")]
SETTINGS = ["mesh.size_body=0.04", "mesh.size=0.3", "time.step=0.004", "time.end=0.2", "body.0.position=[1.0, 0.6]"]
FIGURES = ["steps", "rejected_steps", "remeshes", "smallest_gap", "energy", "reynolds", "rest_position"]
RESULTS = ["bodies.csv", "contacts.csv", "energy.csv", "fields.pvd"]


def command(out, *options):
    return [*COMMAND, "--out", str(out), *options, *(word for setting in SETTINGS for word in ("--set", setting))]


def run_until_killed(out, seconds, *options):
    """Kill the run ``seconds`` after its first output has appeared; False where it was done before that."""
    process = subprocess.Popen(command(out, *options), stdout=subprocess.DEVNULL)
    while not (out / "state.h5").exists() and process.poll() is None:
        time.sleep(0.05)
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return True
    return False


def contents(out):
    files = [out / name for name in RESULTS] + sorted((out / "fields").iterdir())
    summary = json.loads((out / "summary.json").read_text())
    found = {file.relative_to(out).as_posix(): file.read_bytes() for file in files}
    return found | {figure: summary[figure] for figure in FIGURES}


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    out = tmp_path_factory.mktemp("uninterrupted")
    start = time.monotonic()
    subprocess.run(command(out), check=True, stdout=subprocess.DEVNULL)
    return contents(out), time.monotonic() - start


def test_killed_twice_and_resumed_twice(uninterrupted, tmp_path):
    expected, duration = uninterrupted
    out = tmp_path / "killed"
    draw = random.Random(0)
    killed = [run_until_killed(out, draw.uniform(0.0, 0.2) * duration)]
    killed.append(run_until_killed(out, draw.uniform(0.4, 0.6) * duration, "--resume"))
    subprocess.run(command(out, "--resume"), check=True, stdout=subprocess.DEVNULL)
    assert killed[0], "the first run ended before it could be killed"
    assert contents(out) == expected


LOSSY = ["contact.restitution=0.6", "contact.restitution_stokes=10.0"]


@pytest.mark.parametrize("contact", [[], LOSSY], ids=["elastic", "with losses"])
def test_a_run_taken_up_between_the_impacts_of_a_disk_in_a_fluid(tmp_path, contact):
    """Outputs every two steps, so that some lie within contacts: the model of the bodies near them goes on."""
    settings = ["output.every=0.002", "time.step=0.001", *contact]
    whole, first = (
        load_scene(SCENES / "bounce_in_fluid.toml", [*settings, f"time.end={end}"]) for end in (0.016, 0.006)
    )
    rigidfluid.run(whole, tmp_path / "whole")
    rigidfluid.run(first, tmp_path / "parts")
    assert read_checkpoint(tmp_path / "parts" / "state.h5").state.coupling is not None
    rigidfluid.run(whole, tmp_path / "parts", resume=True)
    for name in ("bodies.csv", "contacts.csv", "energy.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_a_run_with_a_tolerance_taken_up_where_its_steps_change(tmp_path):
    """What the next step may be follows from the errors of those before, and these lie in the checkpoint."""
    settings = ["output.every=0.002", "time.step=0.002", "time.tolerance=3e-3"]
    whole, first = (
        load_scene(SCENES / "bounce_in_fluid.toml", [*settings, f"time.end={end}"]) for end in (0.016, 0.004)
    )
    rigidfluid.run(whole, tmp_path / "whole")
    rigidfluid.run(first, tmp_path / "parts")
    rigidfluid.run(whole, tmp_path / "parts", resume=True)
    for name in ("bodies.csv", "energy.csv", "steps.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    sizes = {line.split(",")[2] for line in (tmp_path / "whole" / "steps.csv").read_text().splitlines()[1:]}
    assert len(sizes) > 3


def test_a_run_with_wakes_boxes_and_meshes_made_by_age_is_taken_up_between_them(tmp_path):
    settings = [*SETTINGS, "body.0.position=[1.0, 3.0]", "output.every=0.012", "mesh.remesh_every=0.02"]
    settings += ["mesh.wake={time = 0.05, size = 0.06}"]
    settings += ["mesh.refine=[{lower = [0.5, 2.5], upper = [1.5, 2.8], size = 0.06}]"]
    whole, first = (load_scene(SCENES / "falling_disk.toml", [*settings, f"time.end={end}"]) for end in (0.072, 0.036))
    meshes = rigidfluid.run(whole, tmp_path / "whole").summary["remeshes"]
    assert 0 < rigidfluid.run(first, tmp_path / "parts").summary["remeshes"] < meshes
    rigidfluid.run(whole, tmp_path / "parts", resume=True)
    assert contents(tmp_path / "parts") == contents(tmp_path / "whole")
