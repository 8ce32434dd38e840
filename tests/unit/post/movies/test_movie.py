"""A run as a movie: a picture for each output time, with the bodies where they were; and wrong wishes."""

from __future__ import annotations

import shutil
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from falling import SCENES, falling_disk
from matplotlib import colormaps as cm
from matplotlib.colors import to_rgb
from PIL import Image
from typer.testing import CliRunner

import rigidfluid
from rigidfluid.cli import app
from rigidfluid.core.case.load import load_scene
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.errors import OutputError
from rigidfluid.post.movies import Look, movie
from rigidfluid.post.movies.picture import draw_bodies, flow_image, ground, paint_flow
from rigidfluid.post.movies.shot import shot_of
from rigidfluid.post.movies.small_gif import COLOURS
from rigidfluid.post.reports.canvas import Canvas, body_shells
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.scale import Scale
from rigidfluid.post.reports.style import BODY, HATCH, OUTSIDE, SKY, VERMILLION


@pytest.fixture(scope="module")
def dry(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("dry")
    rigidfluid.run(load_scene(SCENES / "dry_bounce.toml", ["time.end=0.02", "output.every=0.005"]), out)
    return out


@pytest.fixture(scope="module")
def wet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("wet")
    mesh, time = {"size": 0.4, "size_body": 0.1}, {"step": 0.004, "end": 0.012}
    rigidfluid.run(falling_disk(mesh=mesh, time=time, output={"every": 0.004}), out)
    return out


def frames(path: Path) -> list[np.ndarray]:
    with Image.open(path) as file:
        found = []
        for number in range(file.n_frames):
            file.seek(number)
            found.append(np.asarray(file.convert("RGB")))
    return found


def test_a_run_of_a_model_made_in_python_has_a_movie_with_the_model_alone(tmp_path: Path) -> None:
    scene = load_scene(SCENES / "dry_bounce.toml", ["time.end=0.02", "output.every=0.005"])
    made = replace(model_of(scene), name="made")
    rigidfluid.run(made, tmp_path / "run")
    with pytest.raises(OutputError, match=r"made in Python.* or movie\(folder, model=model\)"):
        movie(tmp_path / "run", tmp_path / "a.gif", Look(longer=60))
    with pytest.raises(OutputError, match="results of another model"):
        movie(tmp_path / "run", tmp_path / "a.gif", Look(longer=60), model=replace(made, gravity=(0.0, -1.0)))
    shown = frames(movie(tmp_path / "run", tmp_path / "a.gif", Look(longer=60), model=made))
    tables = scene.to_dict()
    del tables["scene"]["units"]  # a model has no names of units
    rigidfluid.run(rigidfluid.scene_from_dict(tables), tmp_path / "plain")
    as_by_the_scene = frames(movie(tmp_path / "plain", tmp_path / "b.gif", Look(longer=60)))
    assert len(shown) == 5
    np.testing.assert_array_equal(shown, as_by_the_scene)


@pytest.mark.parametrize("run", ["dry", "wet"])
def test_a_picture_for_each_output_time_and_no_two_alike(
    run: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    shown = frames(movie(request.getfixturevalue(run), tmp_path / "a.gif", Look(longer=120)))
    assert len(shown) == {"dry": 5, "wet": 4}[run]
    assert all((one != other).any() for one, other in pairwise(shown))
    assert [path.name for path in tmp_path.iterdir()] == ["a.gif"]


def grey(results: Results, state: int, **look: object) -> tuple[np.ndarray, np.ndarray]:
    """Where the bodies' grey is, as points (N, 2); and the grid's area of a point times their number."""
    grid = shot_of(results, look.get("follow"), look.get("window")).grid(state, 400)
    picture = np.ones((grid.rows, grid.columns, 3))
    draw_bodies(picture, grid, results, state)
    j, i = np.nonzero((picture < 1.0).any(axis=2))
    return grid.origin + i[:, None] * grid.right + j[:, None] * grid.up, len(i) * grid.right[0] * grid.up[1]


def test_bodies_are_where_they_were_and_as_large(wet: Path) -> None:
    results = read_results(wet, motion_only=True)
    points, area = grey(results, -1)
    np.testing.assert_allclose(points.mean(axis=0), results.quantity("position")[-1, 0], atol=0.01)
    assert area == pytest.approx(results.system.bodies[0].volume, rel=0.05)


def test_a_picture_that_follows_a_body_has_it_in_the_middle(wet: Path) -> None:
    results = read_results(wet, motion_only=True)
    shot = shot_of(results, "disk", None)
    for state in (0, -1):
        grid = shot.grid(state, 100)
        middle = grid.coordinates(results.quantity("position")[state, 0])
        np.testing.assert_allclose(middle, (0.5 * (grid.columns - 1), 0.5 * (grid.rows - 1)), atol=1e-9)


def test_the_mark_turns_with_the_body(dry: Path) -> None:
    results = read_results(dry, motion_only=True)
    for angle in (0.0, 2.0):
        results.bodies["angle"][0, 0] = angle
        grid = shot_of(results, None, None).grid(0, 400)
        picture = np.ones((grid.rows, grid.columns, 3))
        draw_bodies(picture, grid, results, 0)
        j, i = np.nonzero((picture == 0.0).all(axis=2))
        way = grid.origin + i[:, None] * grid.right + j[:, None] * grid.up - results.quantity("position")[0, 0]
        way = way[np.linalg.norm(way, axis=1) < 0.11].mean(axis=0)
        assert np.arctan2(way[1], way[0]) == pytest.approx(angle, abs=0.1)


def test_the_fluid_is_shown_as_it_is_in_the_files(wet: Path) -> None:
    results = read_results(wet, motion_only=True)
    grid = shot_of(results, None, None).grid(-1, 200)
    image = flow_image(results.fields(results.series[-1][1]), "speed", grid)
    fastest = np.nanmax(image)
    assert fastest == pytest.approx(-results.bodies["vy"][-1, 0], rel=0.1)
    assert np.isnan(image).sum() * grid.right[0] * grid.up[1] == pytest.approx(results.system.bodies[0].volume, rel=0.1)
    scale = Scale("speed", 0.0, fastest, fastest)
    picture = paint_flow(image, scale)
    outside = np.isnan(image)
    shades = {tuple(colour) for colour in picture[outside].tolist()}
    assert shades == {to_rgb(OUTSIDE), to_rgb(HATCH)}
    np.testing.assert_array_equal(picture[~outside], scale.colours(image[~outside]))
    np.testing.assert_allclose(scale.colours(np.array([0.0, fastest])), [cm["viridis"](x)[:3] for x in (0.0, 1.0)])


def test_bodies_are_drawn_apart_from_what_is_outside(wet: Path) -> None:
    """Of a window larger than the domain; a body's colour is nowhere outside, nor in the ground of a dry run."""
    results = read_results(wet, motion_only=True)
    grid = shot_of(results, None, (-0.5, 0.0, 2.5, 6.0)).grid(-1, 300)
    image = flow_image(results.fields(results.series[-1][1]), "speed", grid)
    picture = paint_flow(image, Scale("speed", 0.0, 1.0, 1.0))
    lines = np.all(picture == to_rgb(HATCH), axis=2)
    assert lines[:, :20].sum() == pytest.approx(0.25 * lines[:, :20].size, rel=0.02)
    assert not np.all(picture == to_rgb(BODY), axis=2).any()
    draw_bodies(picture, grid, results, -1)
    grey = np.argwhere(np.all(picture == to_rgb(BODY), axis=2))
    where = grid.origin + grey[:, 1:] * grid.right + grey[:, :1] * grid.up - results.quantity("position")[-1, 0]
    assert len(grey) > 50
    assert np.linalg.norm(where, axis=1).max() < results.system.bodies[0].bounding_radius
    dry = ground(results, grid)
    np.testing.assert_array_equal(dry[:, :20], picture[:, :20])
    assert np.all(dry[5:-5, 60:-60] == 1.0)


def test_3d_is_cut_in_the_plane_of_gravity_and_motion(tmp_path: Path) -> None:
    settings = ["mesh.size=3.0", "mesh.size_body=0.8", "time.end=0.02", "time.step=0.01", "output.every=0.01"]
    rigidfluid.run(load_scene(SCENES / "falling_sphere.toml", settings), tmp_path / "run")
    results = read_results(tmp_path / "run", motion_only=True)
    shot = shot_of(results, None, None)
    assert shot.plane.up.tolist() == [0.0, 1.0, 0.0]
    grid = shot.grid(0, 60)
    assert abs(grid.plane.normal @ (results.quantity("position")[0, 0] - grid.origin)) < 1e-12
    assert len(frames(movie(tmp_path / "run", tmp_path / "a.gif", Look(show="vorticity", longer=60)))) == 3


@pytest.fixture(scope="module")
def balls(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small ball before a large one, and an ellipsoid beside both, turned about the line of sight; no fluid."""
    out = tmp_path_factory.mktemp("balls")
    bodies = [
        {"name": "before", "type": "sphere", "radius": 0.1, "position": [0.5, 0.5, 0.8]},
        {"name": "behind", "type": "sphere", "radius": 0.3, "position": [0.5, 0.5, 0.35]},
        {"name": "beside", "type": "ellipsoid", "semi_axes": [0.3, 0.1, 0.1], "position": [1.4, 0.5, 0.5]}
        | {"orientation": [np.cos(0.4), 0.0, 0.0, np.sin(0.4)]},
    ]
    data = {
        "scene": {"name": "balls", "dimension": 3},
        "fluid": {"backend": "dry", "gravity": [0.0, -1.0, 0.0]},
        "domain": {"lower": [0.0, 0.0, 0.0], "upper": [2.0, 1.0, 1.0]},
        "body": [{"density": 1.0} | body for body in bodies],
        "time": {"end": 0.1, "step": 0.05},
        "output": {"every": 0.05},
    }
    rigidfluid.run(rigidfluid.scene_from_dict(data), out)
    return out


def test_without_a_fluid_3d_shows_all_bodies_those_in_front_over_those_behind(balls: Path, tmp_path: Path) -> None:
    results = read_results(balls, motion_only=True)
    grid = shot_of(results, None, None).grid(0, 400)
    shells = body_shells(results)
    canvas = Canvas.blank(grid)
    canvas.paint_bodies(shells, results, 0, SKY, VERMILLION)
    picture, shown = canvas.picture, np.isfinite(canvas.depth)
    x = (grid.points() - grid.origin) @ grid.plane.right + grid.origin[0]
    pixel = grid.right[0] * grid.up[1]
    assert shown[x < 1.0].sum() * pixel == pytest.approx(np.pi * 0.3**2, rel=0.02)
    own = grid.points()[shown & (x > 1.0)] - [1.4, 0.5, grid.origin[2]]
    assert len(own) * pixel == pytest.approx(np.pi * 0.3 * 0.1, rel=0.03)
    along = np.linalg.eigh(own.T @ own)[1][:, -1]
    assert np.arctan(along[1] / along[0]) == pytest.approx(0.8, abs=0.01)
    first = Canvas.blank(grid)
    only = {name: values[:, :1] for name, values in results.bodies.items()}
    system = replace(results.system, bodies=results.system.bodies[:1])
    first.paint_bodies(shells[:1], replace(results, bodies=only, system=system), 0, SKY, VERMILLION)
    alone, before = first.picture, np.isfinite(first.depth)
    assert before.sum() * pixel == pytest.approx(np.pi * 0.1**2, rel=0.03)
    np.testing.assert_array_equal(picture[before], alone[before])
    assert len(frames(movie(balls, tmp_path / "a.gif", Look(longer=60)))) == 3


def test_any_plane_can_be_asked_for_in_3d_alone(balls: Path, dry: Path) -> None:
    results = read_results(balls, motion_only=True)
    assert shot_of(results, None, None, "xz").plane.labels == ("x [length]", "z [length]")
    with pytest.raises(OutputError, match="--plane: found xz; allowed is xy, since the run is in 2D"):
        shot_of(read_results(dry, motion_only=True), None, None, "xz")


def test_a_run_that_was_killed_gives_a_movie(wet: Path, tmp_path: Path) -> None:
    killed = Path(shutil.copytree(wet, tmp_path / "killed"))
    (killed / "summary.json").unlink()
    table = killed / "bodies.csv"
    table.write_bytes(table.read_bytes()[:-20])
    assert len(read_results(killed, motion_only=True).time) == len(read_results(wet).time) - 1
    assert len(frames(movie(killed, tmp_path / "a.gif", Look(longer=60)))) == 4
    (killed / "state.h5").unlink()
    with pytest.raises(OutputError, match=r"state\.h5"):
        movie(killed)


@pytest.mark.parametrize(
    ("arguments", "texts"),
    [
        (["--plane", "zx"], ("--plane", "zx")),
        (["--follow", "nobody"], ("--follow", "nobody", "left_disk")),
        (["--out", "a.avi"], ("--out", "a.avi", ".mp4 or .gif")),
        (["--view", "1", "0", "0", "1"], ("--view", "in this order")),
        (["--show", "colour"], ("--show", "colour")),
        (["--size", "1"], ("--size",)),
    ],
)
def test_wrong_wishes(arguments: list[str], texts: tuple[str, ...], dry: Path) -> None:
    result = CliRunner().invoke(app, ["movie", str(dry), *arguments])
    assert result.exit_code == 2
    assert all(text in result.stderr for text in texts)


def test_one_output_time_is_no_movie(wet: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    results = read_results(wet, motion_only=True)
    alone = replace(results, series=results.series[:1])
    monkeypatch.setattr("rigidfluid.post.movies.make_movie.read_results", lambda *_, **__: alone)
    with pytest.raises(OutputError, match="found 1 output times; allowed is two or more"):
        movie(wet, tmp_path / "a.gif")


def test_without_an_encoder_a_gif_is_made_and_an_mp4_refused(
    dry: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rigidfluid.post.movies.make_movie._encoder_path", lambda: None)
    with pytest.raises(OutputError, match=r"Install rigidfluid\[movies\]"):
        movie(dry, tmp_path / "a.mp4")
    assert movie(dry, look=Look(longer=60)).name == "movie.gif"


def test_of_many_output_times_every_second_is_shown(dry: Path, tmp_path: Path) -> None:
    every, second = (movie(dry, tmp_path / f"{n}.gif", Look(longer=60, every=n)) for n in (1, 2))
    np.testing.assert_array_equal(frames(second), frames(every)[::2])


def test_one_picture_makes_no_movie(dry: Path, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="5 output times, of which one in 5 is shown"):
        movie(dry, tmp_path / "a.gif", Look(longer=60, every=5))


def test_no_label_of_a_first_picture_is_cut_off(wet: Path, tmp_path: Path) -> None:
    shown = frames(movie(wet, tmp_path / "a.gif", Look(show="vorticity", longer=340, window=(0.0, 3.0, 1.0, 5.0))))
    for picture in shown:
        edges = picture[[0, -1]].reshape(-1, 3), picture[:, [0, -1]].reshape(-1, 3)
        assert np.concatenate(edges).min() > 200


def test_pictures_of_a_gif_share_their_colours(wet: Path, tmp_path: Path) -> None:
    seen = np.concatenate([frame.reshape(-1, 3) for frame in frames(movie(wet, tmp_path / "a.gif", Look(longer=60)))])
    assert len(np.unique(seen, axis=0)) <= COLOURS
