"""A run goes on from what was written, or is refused by the name of the file that is not as it was."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from falling import falling_disk

import rigidfluid
from rigidfluid.core.output.sealed_file import BLOCK, seal
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import OutputError

SEED = 20261125


def scene(end: float = 0.04) -> Scene:
    """A ball that flies, with a checkpoint at each step."""
    flying = dry_scene({}, ball([0.5, 0.5], [0.1, 0.0]), end=end, step=0.01).to_dict()
    return rigidfluid.scene_from_dict(flying | {"output": {"every": 0.01}})


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    rigidfluid.run(scene(), tmp_path)
    return tmp_path


def refuse_to_resume(folder: Path, name: str, found: str) -> None:
    """A resumption names the file and what was found there, and writes nothing."""
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    with pytest.raises(OutputError, match=rf"{name}: found .*{found}"):
        rigidfluid.run(scene(0.08), folder, resume=True)
    after = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    assert {path: data for path, data in after.items() if path.name != "run.lock"} == {
        path: data for path, data in before.items() if path.name != "run.lock"
    }


@pytest.mark.long
def test_any_bit_of_a_checkpoint_that_has_changed_is_seen(folder: Path) -> None:
    path, random = folder / "state.h5", np.random.default_rng(SEED)
    whole = path.read_bytes()
    for place in random.integers(0, 8 * len(whole), 200):
        damaged = bytearray(whole)
        damaged[place // 8] ^= 1 << (place % 8)
        path.write_bytes(damaged)
        with pytest.raises(OutputError, match=r"state.h5: found (a damaged|no checkpoint)"):
            rigidfluid.run(scene(0.08), folder, resume=True)
    path.write_bytes(whole)
    assert rigidfluid.run(scene(0.08), folder, resume=True).bodies["time"][-1] == pytest.approx(0.08)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.5, 0.999])
def test_a_checkpoint_that_is_cut_off(folder: Path, share: float) -> None:
    path = folder / "state.h5"
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    refuse_to_resume(folder, "state.h5", "checkpoint")


def move_faster(file: h5py.File) -> None:
    file["state"]["twist"]["velocity"][...] = 0.5


def forget_a_past(file: h5py.File) -> None:
    del file["state"]["past"]


def link_outwards(file: h5py.File) -> None:
    del file["times"]
    file["times"] = h5py.ExternalLink("elsewhere.h5", "times")


def call_it_another_format(file: h5py.File) -> None:
    file.attrs["format"] = 1


@pytest.mark.parametrize("edit", [move_faster, forget_a_past, link_outwards, call_it_another_format])
def test_an_edited_checkpoint(folder: Path, edit: Callable[[h5py.File], None]) -> None:
    with h5py.File(folder / "state.h5", "r+") as file:
        edit(file)
    refuse_to_resume(folder, "state.h5", "a damaged or edited checkpoint")


def test_a_checkpoint_of_a_version_without_digests(folder: Path) -> None:
    path = folder / "state.h5"
    path.write_bytes(path.read_bytes()[BLOCK:])
    refuse_to_resume(folder, "state.h5", "no checkpoint of this version")


def put(file: h5py.File, name: str, value: object) -> None:
    del file[name]
    file.create_dataset(name, data=value)


def put_outside(file: h5py.File, name: str) -> None:
    shape = file[name].shape
    del file[name]
    file.create_dataset(name, shape, "f8", external=[("/dev/zero", 0, 8 * int(np.prod(shape)))])


def put_nowhere(file: h5py.File, name: str) -> None:
    del file[name]
    file.create_dataset(name, (1 << 40,), "f8")


EDITS: dict[str, tuple[str, str, Callable[[h5py.File, str], object]]] = {
    "nothing there": ("state/past", "nothing", lambda file, name: file.__delitem__(name)),
    "a number below 0": ("state/tick", "-5", lambda file, name: put(file, name, -5)),
    "another time": ("state/tick", "time", lambda file, name: put(file, name, file[name][()] - 1)),
    "more steps than ticks": ("state/count", "1152", lambda file, name: put(file, name, 1 << 60)),
    "no number": ("state/twist/velocity", "nan", lambda file, name: put(file, name, [[np.nan, 0.0]])),
    "another shape": ("state/twist/velocity", r"\(7, 2\)", lambda file, name: put(file, name, np.zeros((7, 2)))),
    "another type": ("state/gaps", "float32", lambda file, name: put(file, name, np.zeros(1, "f4"))),
    "text": ("elapsed", "object", lambda file, name: put(file, name, "soon")),
    "a negative time": ("elapsed", "-1", lambda file, name: put(file, name, -1.0)),
    "times out of order": ("times", "0.0", lambda file, name: put(file, name, file[name][()][::-1])),
    "no ranks": ("ranks", "0", lambda file, name: put(file, name, 0)),
    "a body that is not there": ("state/contacts/body_a", "9", lambda file, name: put(file, name, file[name][()] + 9)),
    "no table": ("scene", "'{'", lambda file, name: put(file, name, "{")),
    "a scene of nothing": ("", "another scene", lambda file, _: put(file, "scene", "{}")),
    "tables missing": ("tables", "bodies", lambda file, name: file.__delitem__("tables/steps")),
    "a link out": ("times", "a link", lambda file, name: link_outwards(file)),
    "a group": ("times", "a group", lambda file, name: (file.__delitem__(name), file.create_group(name))),
    "data of another file": ("extremes/highest_speed", "values that are not in the file", put_outside),
    "data that is not there": ("times", "values that are not in the file", put_nowhere),
    "another format": ("", "a checkpoint of format", lambda file, _: file.attrs.__setitem__("format", "new")),
}


@pytest.mark.parametrize("edit", EDITS)
def test_an_edited_checkpoint_whose_digest_was_renewed(folder: Path, edit: str) -> None:
    """All that is read is checked, and what is wrong is named."""
    name, found, change = EDITS[edit]
    image = io.BytesIO((folder / "state.h5").read_bytes())
    with h5py.File(image, "r+") as file:
        change(file, name)
    seal(image)
    (folder / "state.h5").write_bytes(image.getbuffer())
    refuse_to_resume(folder, f"state.h5, {name}" if name else "", found)


@pytest.mark.parametrize(
    ("name", "shape", "found"),
    [("state/fluid/twist", (7, 3), r"shape \(7, 3\)"), ("memory/geometry", (2, 2), "cannot take up")],
)
def test_arrays_of_a_fluid_whose_digest_was_renewed(
    tmp_path: Path, name: str, shape: tuple[int, int], found: str
) -> None:
    rigidfluid.run(fall(0.008), tmp_path)
    image = io.BytesIO((tmp_path / "state.h5").read_bytes())
    with h5py.File(image, "r+") as file:
        put(file, name, np.zeros(shape))
    seal(image)
    (tmp_path / "state.h5").write_bytes(image.getbuffer())
    with pytest.raises(OutputError, match=rf"state.h5, {name.partition('/')[0]}.*{found}"):
        rigidfluid.run(fall(0.016), tmp_path, resume=True)


def test_a_mesh_with_a_vertex_that_is_not_there(tmp_path: Path) -> None:
    rigidfluid.run(fall(0.008), tmp_path)
    image = io.BytesIO((tmp_path / "state.h5").read_bytes())
    with h5py.File(image, "r+") as file:
        file["state/reference/mesh/cells"][0, 0] = 10**6
    seal(image)
    (tmp_path / "state.h5").write_bytes(image.getbuffer())
    with pytest.raises(
        OutputError, match=r"state.h5, state/reference/mesh/cells: found 1000000; allowed is numbers below"
    ):
        rigidfluid.run(fall(0.016), tmp_path, resume=True)


@pytest.mark.parametrize("name", ["fields/000001.bodies.vtu", "fields/000000.contacts.vtu"])
def test_a_file_of_an_output_that_is_other_than_the_checkpoint_says(folder: Path, name: str) -> None:
    path = folder / name
    data = path.read_bytes()
    path.write_bytes(data[:-1])
    refuse_to_resume(folder, name, f"{len(data) - 1} bytes")
    path.unlink()
    refuse_to_resume(folder, name, "no such file")


@pytest.mark.parametrize(
    "name", ["bodies.csv", "contacts.csv", "joints.csv", "energy.csv", "steps.csv", "probes.csv", "driving.csv"]
)
def test_a_table_that_is_other_than_the_checkpoint_says(folder: Path, name: str) -> None:
    path = folder / name
    text = path.read_bytes()
    path.write_bytes(text[:-1])
    refuse_to_resume(folder, name, f"{len(text) - 1} bytes")
    path.write_bytes(bytes([text[0] ^ 1]) + text[1:])
    refuse_to_resume(folder, name, "other content")
    path.unlink()
    refuse_to_resume(folder, name, "no such file")


@pytest.mark.parametrize("damage", [Path.unlink, lambda path: path.write_text("<VTKFile"), lambda path: path.touch()])
def test_a_list_of_fields_is_made_again(tmp_path: Path, damage: Callable[[Path], object]) -> None:
    """It follows from the checkpoint and the fields that are there."""
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    rigidfluid.run(fall(0.024), whole)
    rigidfluid.run(fall(0.008), broken)
    damage(broken / "fields.pvd")
    (broken / "fields" / "000002.pvtu").write_text("of several processes that were killed here")
    rigidfluid.run(fall(0.016), broken, resume=True)
    rigidfluid.run(fall(0.024), broken, resume=True)
    assert (broken / "fields.pvd").read_bytes() == (whole / "fields.pvd").read_bytes()


def fall(end: float) -> Scene:
    """A disk in a fluid on a coarse mesh, with fields at each second step."""
    return falling_disk(
        fluid={},
        time={"step": 0.004, "end": end},
        mesh={"size": 0.5, "size_body": 0.12},
        output={"every": 0.008},
    )


def test_lines_behind_the_checkpoint_are_cut_off(folder: Path) -> None:
    with (folder / "bodies.csv").open("a") as file:
        file.write("a line of a run that was killed")
    resumed, whole = rigidfluid.run(scene(0.08), folder, resume=True), rigidfluid.run(scene(0.08))
    np.testing.assert_array_equal(resumed.bodies["x"], whole.bodies["x"])


@pytest.mark.parametrize("change", [Path.unlink, lambda path: path.write_text("time\n")])
def test_a_table_that_changes_during_a_run(tmp_path: Path, change: Callable[[Path], object]) -> None:
    changed: list[object] = []

    def meddle(_: object) -> None:
        if not changed:
            changed.append(change(tmp_path / "bodies.csv"))

    with pytest.raises(OutputError, match=r"bodies.csv: found"):
        rigidfluid.run(scene(), tmp_path, progress=meddle)
    assert json.loads((tmp_path / "summary.json").read_text())["status"].startswith("stopped")


def test_an_end_before_the_checkpoint(folder: Path) -> None:
    with pytest.raises(OutputError, match=r"found an end at 0.02, before the checkpoint's time 0.04"):
        rigidfluid.run(scene(0.02), folder, resume=True)
    assert rigidfluid.run(scene(), folder, resume=True).summary["status"] == "complete"


SOLID = """solid tetrahedron
facet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet
facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet
facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet
facet normal 1 1 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet
endsolid tetrahedron
"""


@pytest.mark.long
def test_a_file_of_the_scene_that_has_changed(tmp_path: Path) -> None:
    file, out = tmp_path / "body.stl", tmp_path / "out"
    file.write_text(SOLID)
    body = {"type": "stl", "file": str(file), "density": 1.0, "position": [3.0, 3.0, 3.0]}

    def resumed(end: float) -> None:
        flying = dry_scene({}, body, end=end, step=0.01, upper=[6.0] * 3).to_dict()
        flying["output"]["every"] = 0.01
        rigidfluid.run(rigidfluid.scene_from_dict(flying), out, resume=end > 0.01)

    resumed(0.01)
    resumed(0.02)
    file.write_text(SOLID.replace("vertex 1 0 0", "vertex 1.01 0 0"))
    with pytest.raises(OutputError, match=r"body.stl: found a file that has changed since the checkpoint"):
        resumed(0.03)


@pytest.mark.long
def test_a_file_of_the_scene_that_changes_during_the_run(tmp_path: Path) -> None:
    """What the run has read counts, and not what lies there at its checkpoints."""
    file, out = tmp_path / "body.stl", tmp_path / "out"
    file.write_text(SOLID)
    body = {"type": "stl", "file": str(file), "density": 1.0, "position": [3.0, 3.0, 3.0]}
    flying = dry_scene({}, body, end=0.02, step=0.01, upper=[6.0] * 3)
    rigidfluid.run(flying, out, progress=lambda _: file.write_text(SOLID.replace("vertex 1 0 0", "vertex 1.01 0 0")))
    with pytest.raises(OutputError, match=r"body.stl: found a file that has changed since the checkpoint"):
        rigidfluid.run(flying, out, resume=True)
