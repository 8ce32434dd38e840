"""Reports, movies and statistics of runs whose bodies enter and leave."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from html import unescape
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from scenes import dry_tables, wet_tables

import rigidfluid
from rigidfluid.api import Simulation, load_results, scene_from_dict
from rigidfluid.errors import OutputError
from rigidfluid.post.movies import Look, movie
from rigidfluid.post.movies.picture import draw_bodies
from rigidfluid.post.movies.shot import shot_of
from rigidfluid.post.reports import report
from rigidfluid.post.reports.bodies import placed_bodies
from rigidfluid.post.reports.canvas import Canvas, body_shells
from rigidfluid.post.reports.coefficients import figures, reference
from rigidfluid.post.reports.contact_plot import contact_plot
from rigidfluid.post.reports.lines import speed_plot
from rigidfluid.post.reports.moment import Moment, moment, narrowest
from rigidfluid.post.reports.narrowest import gap_middle
from rigidfluid.post.reports.pictures import mesh_picture
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.rotation_plot import turned, turning
from rigidfluid.post.reports.scale import Scale
from rigidfluid.post.reports.style import BODY, SKY, VERMILLION
from rigidfluid.post.reports.view_plane import plane_of_motion, view_plane
from rigidfluid.post.statistics.measure import measured

BALL = {"type": "sphere", "radius": 0.08, "density": 2.0}
WHERE = {"a": (0.2, 0.7), "b": (0.8, 0.7), "guest": (0.5, 0.4)}
STEP = 0.01
ENTERS, LEAVES = 2, 4
"""States with which the guest enters and the first body leaves."""
PRESENT = np.array([[k <= LEAVES, True, k > ENTERS] for k in range(7)])


def body(name: str, dimension: int, **more: Any) -> dict[str, Any]:
    return BALL | {"name": name, "position": [*WHERE[name], 0.5][:dimension]} | more


def exchange(tables: dict[str, Any], guest: dict[str, Any], folder: Path, *, end: int = 6) -> Simulation:
    """A run in a folder, not summed up, in which a guest enters and the first body leaves."""
    run = Simulation(scene_from_dict(tables | {"output": {"every": STEP}}), folder)
    run.go(ENTERS * STEP)
    run.add(guest)
    run.go(LEAVES * STEP)
    run.remove("a")
    run.go(end * STEP)
    return run


@pytest.fixture(scope="module")
def dry(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Balls in 3D that fall, the guest faster; the last one is pressed on the bottom."""
    folder = tmp_path_factory.mktemp("dry")
    tables = dry_tables(
        body("a", 3), body("b", 3, position=[0.8, 0.5, 0.085]), end=6 * STEP, step=STEP,
        fluid={"gravity": [0.0, 0.0, -9.8]},
        contact={"law": "spring-dashpot", "range": 0.01, "stiffness": 1e4},
    )  # fmt: skip
    guest = body("guest", 3, velocity=[0.5, 0.0, 0.0], angular_velocity=[0.0, 6.0, 0.0])
    run = exchange(tables, guest, folder)
    run.finish("complete")
    run.close()
    return folder


@pytest.fixture(scope="module")
def unfinished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Disks in 2D without a summary."""
    folder = tmp_path_factory.mktemp("unfinished")
    exchange(dry_tables(body("a", 2), body("b", 2), end=1.0, step=STEP), body("guest", 2), folder).close()
    return folder


@pytest.fixture(scope="module")
def wet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wet")
    tables = wet_tables(body("a", 2), body("b", 2), end=6 * STEP, step=STEP, fluid={"gravity": [0.0, -9.8]})
    run = exchange(tables, body("guest", 2, prescribed={"velocity": [0.0, 1.0]}), folder)
    run.finish("complete")
    run.close()
    return folder


@pytest.fixture
def falling(dry: Path) -> Results:
    return read_results(dry)


def test_results_have_all_bodies_that_were_ever_there(dry: Path, falling: Results) -> None:
    assert falling.names == ("a", "b", "guest")
    np.testing.assert_array_equal(falling.present, PRESENT)
    np.testing.assert_allclose(falling.time, STEP * np.arange(7))
    table = load_results(dry).bodies
    for name, column in table.items():
        if name != "body":
            np.testing.assert_array_equal(falling.bodies[name][PRESENT], column)
    assert np.isnan(falling.bodies["vx"][~PRESENT]).all()
    assert np.isposinf(falling.bodies["gap"][~PRESENT]).all()
    np.testing.assert_array_equal(falling.bodies["step"], np.repeat(np.arange(7)[:, None], 3, axis=1))
    assert len(falling.energy["kinetic"]) == 7


def test_a_path_begins_and_ends_with_the_body(falling: Results) -> None:
    position = falling.quantity("position")
    np.testing.assert_array_equal(falling.path(2)[: ENTERS + 1], [position[ENTERS + 1, 2]] * 3)
    np.testing.assert_array_equal(falling.path(0)[LEAVES:], [position[LEAVES, 0]] * 3)
    np.testing.assert_array_equal(falling.path(1), position[:, 1])


def test_bodies_that_are_there_are_placed(falling: Results) -> None:
    for state, present in enumerate(PRESENT):
        assert [one.number for one in placed_bodies(falling, state)] == np.flatnonzero(present).tolist()
    (last,) = (one for one in placed_bodies(falling, 6) if one.number == 2)
    assert last.shape is falling.system.bodies[2]
    np.testing.assert_array_equal(last.centre, falling.quantity("position")[6, 2])
    c, s = np.cos(6.0 * 4 * STEP), np.sin(6.0 * 4 * STEP)
    np.testing.assert_allclose(last.turn, [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]], atol=1e-9)


def test_a_body_turns_from_when_it_enters(falling: Results) -> None:
    np.testing.assert_allclose(turned(falling)[ENTERS + 1 :, 2], 6.0 * STEP * np.arange(4), atol=1e-7)
    assert turning(falling).tolist() == [False, False, True]


def test_the_plane_is_that_of_all_motion(falling: Results) -> None:
    """The guest alone moves sideways, along x."""
    assert plane_of_motion(falling).words == "xz-plane"


def test_the_largest_force_is_that_on_a_body_that_is_there(falling: Results) -> None:
    force = np.linalg.norm(falling.quantity("contact_force"), axis=2)[:, 1]
    weight = np.linalg.norm(falling.system.weight[1])
    assert force.max() > 0.0
    np.testing.assert_allclose(contact_plot(falling).axes[1].lines[0].get_ydata(), force / weight)


@pytest.mark.parametrize(("state", "pixels"), [(0, {0, 1}), (3, {0, 1, 2}), (6, {1, 2})])
def test_a_picture_in_space_shows_who_is_there(falling: Results, state: int, pixels: set[int]) -> None:
    canvas = Canvas.blank(shot_of(falling, None, None).grid(state, 200))
    canvas.paint_bodies(body_shells(falling), falling, state, SKY, VERMILLION)
    places = canvas.grid.coordinates(np.array([falling.path(number)[state] for number in range(3)]))
    depth = [canvas.depth[round(j), round(i)] for i, j in places]
    assert set(np.flatnonzero(np.isfinite(depth)).tolist()) == pixels


def test_a_movie_follows_a_body_that_enters(falling: Results) -> None:
    shot = shot_of(falling, "guest", None)
    seen = view_plane(falling).flat(falling.path(2))
    np.testing.assert_array_equal(shot.shift, seen)


@pytest.mark.long
def test_the_report_of_a_run_in_space(dry: Path) -> None:
    names = {path.name for path in report(dry)}
    assert {"space.png", "position.png", "rotation.png", "torque.png", "contacts.png", "report.html"} <= names
    page = unescape((dry / "report.html").read_text(encoding="utf-8"))
    table = page.partition("Bodies that entered or left</h2>")[2].partition("</table>")[0]
    cells = [row.replace("</td>", "").split('<td class="n">')[1:] for row in table.split("<tr>")[2:]]
    mass = f"{2.0 * 4.0 / 3.0 * np.pi * 0.08**3:.5g}"
    told = [[cell.split("<")[0] for cell in row] for row in cells]
    assert told == [["a", "", "0.04", mass], ["guest", "0.02", "", mass]]
    assert movie(dry, dry / "movie.gif").exists()


def test_statistics_are_of_the_bodies_that_are_there(dry: Path, falling: Results) -> None:
    tables = {"contacts": load_results(dry).contacts, "stresslets": {}, "walls": {}}
    found = measured(falling, tables, 0.0, None, "y")
    np.testing.assert_array_equal(found.samples.present, PRESENT)
    for since, until, names in [(0.0, 0.02, ("a", "b")), (0.05, None, ("b", "guest"))]:
        assert measured(falling, tables, since, until, "y").samples.name == names


@pytest.mark.long
def test_the_report_of_a_run_in_a_fluid(wet: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It shows the mesh about the guest while that is there."""
    panels: list[float] = []

    def draw(shown: Sequence[Moment], scale: Scale) -> Figure:
        panels.extend(moment.time for moment in shown)
        return mesh_picture(shown, scale)

    monkeypatch.setattr(import_module("rigidfluid.post.reports.report"), "mesh_picture", draw)
    names = {path.name for path in report(wet, follow="guest")}
    assert {"speed_field.png", "mesh.png", "smallest_gap.png", "speed.png", "coefficients.png"} <= names
    assert panels == pytest.approx([0.03, 0.04, 0.06])
    assert movie(wet, wet / "movie.gif", Look(follow="a")).exists()


def test_pictures_of_a_flow_show_who_is_there(wet: Path) -> None:
    results = read_results(wet)
    for state, present in enumerate(PRESENT):
        if state >= len(results.series):
            break
        time = results.series[state][0]
        row = results.state_at(time)
        grid = shot_of(results, None, None).grid(row, 100)
        picture = np.ones((grid.rows, grid.columns, 3))
        draw_bodies(picture, grid, results, row)
        off = [grid.coordinates(results.path(number)[row] - [0.03, 0.0]) for number in range(3)]
        grey = [bool(np.allclose(picture[round(j), round(i)], to_rgb(BODY))) for i, j in off]
        assert grey == present.tolist()
        view = moment(results, state, view_plane(results), 2)
        assert len(view.outlines) == present.sum()
        assert view.has_body == present[2]


def test_a_gap_of_a_body_that_is_not_there_has_no_middle(wet: Path) -> None:
    results, plane = read_results(wet), view_plane(read_results(wet))
    output, nearest = narrowest(results, None)
    state = results.state_at(results.series[output][0])
    assert gap_middle(results, state, nearest, plane) is not None
    assert gap_middle(results, 0, 2, plane) is None


def test_coefficients_are_of_the_time_in_which_a_body_is_there(wet: Path) -> None:
    results = read_results(wet)
    by = reference(results)
    assert by is not None
    assert by.speed == pytest.approx(1.0)
    assert np.isfinite([found.drag for found in figures(results, by)]).all()


def test_the_highest_reynolds_number_is_that_of_a_body_that_is_there(wet: Path) -> None:
    results = read_results(wet)
    speed = np.linalg.norm(results.quantity("velocity"), axis=2)
    highest = 2.0 * 0.08 * np.nanmax(speed) / 0.1
    assert speed_plot(results).axes[1].texts[0].get_text() == f"highest {highest:.4g}"


def test_an_unfinished_run_is_read_with_the_bodies_of_its_checkpoint(unfinished: Path) -> None:
    results = read_results(unfinished)
    assert results.summary == {}
    np.testing.assert_array_equal(results.present, PRESENT)
    assert "report.html" in {path.name for path in report(unfinished)}
    assert movie(unfinished, unfinished / "movie.gif").exists()
    assert len(load_results(unfinished).bodies["x"]) == PRESENT.sum()


def append(folder: Path, name: str, text: str) -> None:
    with (folder / name).open("a", encoding="utf-8") as file:
        file.write(text)


def last_lines(folder: Path, count: int) -> str:
    return "".join((folder / "bodies.csv").read_text(encoding="utf-8").splitlines(keepends=True)[-count:])


@pytest.mark.parametrize("other", ["b", "another"])
def test_states_after_the_checkpoint_that_are_not_whole_are_dropped(
    unfinished: Path, tmp_path: Path, other: str
) -> None:
    """The next state has a row of one of two bodies and none of energies; or a row of energies, and a body that
    nobody knows."""
    folder = Path(shutil.copytree(unfinished, tmp_path / "run"))
    row = last_lines(folder, 2).splitlines(keepends=True)[0].replace("0.06,6,b", f"0.07,7,{other}")
    assert f",7,{other}," in row
    append(folder, "bodies.csv", row)
    if other == "another":
        energy = (folder / "energy.csv").read_text(encoding="utf-8").splitlines()[-1]
        append(folder, "energy.csv", energy.replace("0.06,6,", "0.07,7,") + "\n")
    results = read_results(folder)
    np.testing.assert_array_equal(results.present, PRESENT)
    assert len(results.energy["kinetic"]) == len(results.time) == 7
    assert len(read_results(folder, motion_only=True).time) == 7


def test_a_body_that_came_after_the_checkpoint_ends_the_results(tmp_path: Path) -> None:
    """The checkpoint is of the start; the tables have two more states of one body, and then two of two."""
    run = Simulation(scene_from_dict(dry_tables(body("a", 2), end=1.0, step=STEP)), tmp_path)
    run.go(ENTERS * STEP)
    run.add(body("guest", 2))
    run.go(LEAVES * STEP)
    run.close()
    results = read_results(tmp_path)
    assert results.names == ("a",)
    assert len(results.time) == len(results.energy["kinetic"]) == ENTERS + 1
    assert results.present.all()


@pytest.mark.parametrize(
    ("change", "found"),
    [
        (lambda text: text.replace(",guest,", ",stranger,"), "a body 'stranger' that has not entered"),
        (lambda text: text + text.splitlines(keepends=True)[-1], "two rows of a body in a state"),
    ],
)
def test_a_table_that_no_run_has_written_is_refused(dry: Path, tmp_path: Path, change: Any, found: str) -> None:
    folder = Path(shutil.copytree(dry, tmp_path / "run"))
    text = (folder / "bodies.csv").read_text(encoding="utf-8")
    (folder / "bodies.csv").write_text(change(text), encoding="utf-8")
    with pytest.raises(OutputError, match=found):
        read_results(folder)


def test_a_body_that_was_there_in_no_state_is_left_out(dry: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(dry, tmp_path / "run"))
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    summary["population"]["entered"].append(body("guest", 3) | {"name": "late"})
    (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    assert read_results(folder).names == ("a", "b", "guest")


def test_bodies_of_a_source_are_reported(tmp_path: Path) -> None:
    source = {
        "name": "grain", "shape": [{"type": "sphere", "radius": 0.05}], "density": 2.0, "every": 0.02,
        "region": {"type": "box", "lower": [0.1, 0.1], "upper": [0.9, 0.4]},
    }  # fmt: skip
    tables = dry_tables(body("a", 2), end=0.05, step=STEP, source=[source], output={"every": STEP})
    rigidfluid.run(scene_from_dict(tables), tmp_path)
    assert read_results(tmp_path).names == ("a", "grain0", "grain1", "grain2")
    assert "report.html" in {path.name for path in report(tmp_path)}
