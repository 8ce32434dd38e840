"""Bodies and contacts next to the fields: as other programs read them, and as the tables have them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from falling import falling_disk

import rigidfluid
from rigidfluid.core.output.history import History
from rigidfluid.core.output.vtu import read_pvd

pyvista = pytest.importorskip("pyvista")
meshio = pytest.importorskip("meshio")

LAW = {"law": "centre", "range": 0.2, "epsilon": 1e-3, "epsilon_wall": 1e-3}
FALL = {"mesh": {"size": 0.5, "size_body": 0.12}, "output": {"every": 0.008}}


def three_balls(dimension: int) -> rigidfluid.Scene:
    """Two balls near each other and the floor, and one far from all."""
    places = [[0.5, 0.16], [0.66, 0.34], [1.6, 0.8]]
    balls = [ball([*place, *[0.5] * (dimension - 2)], [0.01, -0.02, 0.03][:dimension]) for place in places]
    scene = dry_scene(LAW, *balls, end=0.2, step=0.01, upper=[2.0, 1.0, 1.0][:dimension]).to_dict()
    scene["output"]["every"] = 0.1
    return rigidfluid.scene_from_dict(scene)


def rows_at(history: History, table: str, time: float) -> dict[str, np.ndarray]:
    columns = history.table(table)
    now = np.isclose(columns["time"], time, rtol=0.0, atol=1e-12)
    return {name: values[now] for name, values in columns.items()}


def vectors(rows: dict[str, np.ndarray], prefix: str, dimension: int) -> np.ndarray:
    """With three components, the last of the plane's zero."""
    flat = np.stack([rows[prefix + axis] for axis in "xyz"[:dimension]], axis=-1)
    return np.pad(flat, ((0, 0), (0, 3 - dimension)))


@pytest.mark.parametrize("dimension", [2, 3])
def test_bodies_are_those_of_the_table(tmp_path: Path, dimension: int) -> None:
    history = rigidfluid.run(three_balls(dimension), tmp_path)
    series = read_pvd(tmp_path / "fields.pvd", "bodies")
    assert [time for time, _ in series] == pytest.approx([0.0, 0.1, 0.2])
    for time, path in series:
        read, rows = meshio.read(path), rows_at(history, "bodies", time)
        found = read.point_data
        assert found["id"].tolist() == [0, 1, 2]
        np.testing.assert_array_equal(read.points, vectors(rows, "", dimension))
        for name, prefix in (("velocity", "v"), ("force", "f"), ("contact_force", "cf")):
            np.testing.assert_array_equal(found[name], vectors(rows, prefix, dimension))
        if dimension == 2:
            turns = (("angle", "angle"), ("angular_velocity", "w"), ("torque", "t"), ("contact_torque", "ct"))
            for name, column in turns:
                np.testing.assert_array_equal(found[name], rows[column])
        else:
            np.testing.assert_array_equal(found["quaternion"], np.stack([rows[f"q{k}"] for k in "wxyz"], axis=1))
            for name, prefix in (("angular_velocity", "w"), ("torque", "t"), ("contact_torque", "ct")):
                np.testing.assert_array_equal(found[name], vectors(rows, prefix, 3))
    assert np.abs(found["contact_force"]).max() > 0.0


@pytest.mark.parametrize("dimension", [2, 3])
def test_contacts_have_opposite_forces_at_their_two_ends(tmp_path: Path, dimension: int) -> None:
    history = rigidfluid.run(three_balls(dimension), tmp_path)
    names = ["body0", "body1", "body2", "left", "right", "bottom", "top", "back", "front"]
    for time, path in read_pvd(tmp_path / "fields.pvd", "contacts")[1:]:
        read, rows = meshio.read(path), rows_at(history, "contacts", time)
        assert len(rows["a"]) >= 1
        ends = read.cells_dict["line"]
        force, surface = read.point_data["force"][ends], read.point_data["surface"][ends]
        np.testing.assert_array_equal(force[:, 0], vectors(rows, "f", dimension))
        np.testing.assert_array_equal(force[:, 1], -force[:, 0])
        assert np.linalg.norm(force[:, 0], axis=1).min() > 0.0
        assert [[names[k] for k in pair] for pair in surface] == np.stack([rows["a"], rows["b"]], axis=1).tolist()
        first, second = read.points[ends].swapaxes(0, 1)
        np.testing.assert_array_equal(first, vectors(rows, "a", dimension))
        np.testing.assert_array_equal(second, vectors(rows, "b", dimension))
        np.testing.assert_allclose(np.linalg.norm(first - second, axis=1), read.point_data["gap"][ends[:, 0]])


def test_one_series_has_fluid_bodies_and_contacts(tmp_path: Path) -> None:
    rigidfluid.run(falling_disk(time={"step": 0.004, "end": 0.008}, **FALL), tmp_path)
    reader = pyvista.get_reader(tmp_path / "fields.pvd")
    assert [(one.time, one.part, Path(one.path).name) for one in reader.datasets] == [
        (time, part, f"{number:06d}{ending}.vtu")
        for number, time in enumerate((0.0, 0.008))
        for part, ending in enumerate(("", ".bodies", ".contacts"))
    ]
    reader.set_active_time_value(0.008)
    fluid, bodies, contacts = reader.read()
    assert {"velocity", "pressure", "vorticity"} == set(fluid.point_data.keys())
    assert (bodies.n_points, contacts.n_points) == (1, 0)


def contents(folder: Path) -> dict[str, bytes]:
    files = [folder / "fields.pvd", *(folder / "fields").iterdir()]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_a_resumption_writes_again_what_was_written_behind_its_checkpoint(tmp_path: Path) -> None:
    """A kill between an output and its checkpoint leaves files that are made anew before the series lists them."""
    scenes = [falling_disk(time={"step": 0.004, "end": end}, **FALL) for end in (0.008, 0.016)]
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    rigidfluid.run(scenes[1], whole)
    rigidfluid.run(scenes[0], killed)
    before = contents(killed)
    for name, content in contents(whole).items():
        (killed / name).write_bytes(content)
    (killed / "fields" / "000002.bodies.vtu").write_text("<VTKFile")
    rigidfluid.run(scenes[0], killed, resume=True)
    assert contents(killed)["fields.pvd"] == before["fields.pvd"]
    rigidfluid.run(scenes[1], killed, resume=True)
    assert contents(killed) == contents(whole)
