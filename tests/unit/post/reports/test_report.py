"""Reports of a short fall, of a run without a fluid, and of folders that cannot be read."""

from __future__ import annotations

import json
import re
import shutil
import sys
from datetime import UTC, datetime
from html import unescape
from importlib.util import find_spec
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from falling import SCENES, falling_disk
from scenes import dry_tables

import rigidfluid
from rigidfluid import registry, run, scene_from_dict
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.energy_account import per_cent
from rigidfluid.core.output.vtu import read_pvd, read_vtu, write_vtu
from rigidfluid.core.run.run import Progress
from rigidfluid.core.run.summary import FLOWS
from rigidfluid.errors import OutputError, PluginError
from rigidfluid.post.movies import Look, movie
from rigidfluid.post.reports import report
from rigidfluid.post.reports.lines import energy_plot
from rigidfluid.post.reports.results import read_results
from rigidfluid.post.reports.style import STYLE

PNG = b"\x89PNG\r\n"
FIELD_PICTURES = {
    f"{name}.png"
    for name in ("speed_field", "streamlines", "vorticity", "pressure", "whole_mesh", "mesh", "smallest_gap")
}
CURVES = {"position", "speed", "gap", "force", "energy"}
OF_A_FALL = CURVES | {"step"}


@pytest.fixture(scope="module")
def fall(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fall")
    scene = falling_disk(
        mesh={"size": 0.4, "size_body": 0.08},
        time={"step": 0.01, "end": 0.03, "tolerance": 0.1},
        output={"every": 0.01},
    )
    rigidfluid.run(scene, folder)
    return folder


@pytest.fixture(scope="module")
def written(fall: Path) -> list[Path]:
    return report(fall)


@pytest.fixture
def copy(fall: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(fall, tmp_path / "copy"))


@pytest.mark.long
def test_files_of_a_run_with_a_fluid(written: list[Path]) -> None:
    names = {path.name for path in written}
    assert names == FIELD_PICTURES | {f"{name}.{kind}" for name in OF_A_FALL for kind in ("png", "svg")} | {
        "report.html"
    }
    assert all(path.stat().st_size > 0 for path in written)
    assert all(path.read_bytes().startswith(PNG) for path in written if path.suffix == ".png")


def test_the_page_needs_no_other_file(fall: Path, written: list[Path]) -> None:
    page = written[-1].read_text(encoding="utf-8")
    summary = json.loads((fall / "summary.json").read_text())
    assert page.count("data:image/png;base64,") == len(FIELD_PICTURES | OF_A_FALL)
    assert 'src="' not in page.replace('src="data:', "")
    for figure in (summary["reynolds"], summary["smallest_gap"], summary["energy"]["dissipation"]):
        assert f"{figure:.5g}" in page
    for share in (*FLOWS, "unaccounted"):
        assert per_cent(summary["energy"][share]) in page
    for energy in ("put_in", "at_hand"):
        assert f"{summary['energy'][energy]:.5g}" in page
    assert "friction of impacts between the fluid's solutions" in unescape(page)
    assert "size_body = 0.08" in page
    assert "of it: advance [s]" in page
    assert f"{summary['peak_memory'] / 1e6:.5g}" in page


@pytest.mark.long
def test_the_same_run_gives_the_same_files(fall: Path, written: list[Path]) -> None:
    first = {path: path.read_bytes() for path in written}
    assert {path: path.read_bytes() for path in report(fall)} == first


def test_the_contents_and_the_data_of_a_page_are_there(fall: Path, written: list[Path]) -> None:
    page = written[-1].read_text(encoding="utf-8")
    contents = re.search("<nav>(.*)</nav>", page)
    assert contents is not None
    links = dict(re.findall(r'<a href="#([^"]+)">([^<]+)</a>', contents[1]))
    assert {"Pictures", "Energy balance", "Cost", "Data", "Scene", "Versions"} == set(links.values())
    assert links == dict(re.findall(r'<h2 id="([^"]+)">([^<]+)</h2>', page))
    files = set(re.findall(r'href="([^"#]+)"', page))
    assert {"bodies.csv", "energy.csv", "fields.pvd", "state.h5", "summary.json"} <= files
    assert all((fall / name).is_file() for name in files)
    day = datetime.fromtimestamp((fall / "bodies.csv").stat().st_mtime, UTC)
    assert f"Results of {day:%Y-%m-%d %H:%M} UTC" in page


@pytest.mark.long
@pytest.mark.parametrize("torn", ["bodies", "energy", "steps"])
def test_a_run_that_goes_on_has_a_report(copy: Path, torn: str) -> None:
    """No summary yet, a row half written, in one table before the others, and contacts of a later state."""
    (copy / "summary.json").unlink()
    whole = read_results(copy)
    table = copy / f"{torn}.csv"
    table.write_bytes(table.read_bytes()[:-7])
    columns = (copy / "contacts.csv").read_text().split(",")
    later = ["9.0", "999", "disk", "bottom", *["0.0"] * (len(columns) - 4)]
    with (copy / "contacts.csv").open("a") as file:
        file.write(",".join(later) + "\n")
    results = read_results(copy)
    states = len(whole.time) - (torn != "steps")
    assert len(results.time) == len(results.energy["time"]) == len(results.contact_counts) == states
    assert results.contact_counts.sum() == 0.0
    np.testing.assert_array_equal(results.quantity("velocity"), whole.quantity("velocity")[:states])
    page = unescape(report(copy)[-1].read_text(encoding="utf-8"))
    assert f"goes on, or was stopped; resumed by --resume, at {results.time[-1]:.5g} of 0.03" in page
    assert page.count("data:image/png;base64,") == len(FIELD_PICTURES | OF_A_FALL)
    assert "Energy balance" not in page
    assert "size_body = 0.08" in page


def test_the_scene_on_the_page_is_a_scene(fall: Path, written: list[Path]) -> None:
    import tomllib

    page = written[-1].read_text(encoding="utf-8")
    text = unescape(page.partition("<pre>")[2].partition("</pre>")[0])
    assert tomllib.loads(text) == json.loads((fall / "summary.json").read_text())["scene"]


@pytest.mark.long
def test_a_backend_that_is_missing_here_has_its_report(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run on a cluster, looked at elsewhere."""
    for package in ("dolfinx", "petsc4py", "mpi4py"):
        monkeypatch.setitem(sys.modules, package, None)  # importing it fails
    monkeypatch.setattr(registry, "find_spec", lambda name: None if name == "dolfinx" else find_spec(name))
    summary = json.loads((copy / "summary.json").read_text())
    summary["scene"]["fluid"] |= {"backend": "dolfinx", "solver": "schur", "petsc": {"pc_type": "lu"}}
    (copy / "summary.json").write_text(json.dumps(summary))
    with pytest.raises(PluginError, match=r"'dolfinx', which is not usable here; .* Package dolfinx is missing"):
        rigidfluid.scene_from_dict(summary["scene"])
    assert all(path.exists() for path in report(copy))
    assert movie(copy, copy / "movie.gif", Look(longer=60)).exists()


def test_run_without_a_fluid(tmp_path: Path) -> None:
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=0.01"])
    rigidfluid.run(scene, tmp_path)
    written = report(tmp_path)
    assert not FIELD_PICTURES & {path.name for path in written}
    assert "no fluid" in written[-1].read_text(encoding="utf-8")


def test_a_page_warns_of_energy_as_the_command_does(tmp_path: Path) -> None:
    coarse = ["contact.substeps=1", "time.end=0.03", "time.step=3e-4"]
    history = rigidfluid.run(rigidfluid.load_scene(SCENES / "dry_bounce.toml", coarse), tmp_path)
    report(tmp_path)
    page = unescape((tmp_path / "report.html").read_text(encoding="utf-8"))
    warnings = history.summary["energy"]["warnings"]
    assert warnings
    for warning in warnings:
        assert f"Serious warning: {warning['text']}. {warning['remedy']}" in page


def test_bodies_too_many_to_tell_apart(tmp_path: Path) -> None:
    places = [(x, y) for x in np.linspace(0.1, 0.9, 5) for y in np.linspace(0.1, 0.9, 5)]
    body = [{"type": "sphere", "radius": 0.05, "density": 1.0, "position": list(map(float, place))} for place in places]
    rigidfluid.run(
        rigidfluid.scene_from_dict(dry_tables(*body, end=0.02, fluid={"gravity": [0.0, -1.0]}, output={"every": 0.01})),
        tmp_path,
    )
    written = report(tmp_path)
    assert len(written) == 2 * len(CURVES) + 1
    assert "17 more bodies" in written[-1].read_text(encoding="utf-8")


def test_a_body_alone_has_no_gap_to_show(tmp_path: Path) -> None:
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=2e-5"]).to_dict()
    scene["boundary"], scene["body"] = [{"on": "all", "type": "slip"}], scene["body"][:1]
    rigidfluid.run(rigidfluid.scene_from_dict(scene), tmp_path)
    assert not any(path.stem == "gap" for path in report(tmp_path))


@pytest.mark.parametrize("name", ["bodies.csv", "energy.csv", "fields/000001.vtu"])
def test_missing_file_is_named(copy: Path, name: str) -> None:
    (copy / name).unlink()
    refused(copy, name, "--resume")


@pytest.mark.parametrize("name", ["summary.json", "bodies.csv", "energy.csv", "fields.pvd", "fields/000001.vtu"])
def test_file_cut_off_is_named(copy: Path, name: str) -> None:
    content = (copy / name).read_bytes()
    (copy / name).write_bytes(content[: int(0.8 * len(content)) - 3])
    refused(copy, name, "--resume")


def test_a_folder_of_something_else_is_refused(tmp_path: Path) -> None:
    refused(tmp_path, "neither summary.json nor state.h5", "run the scene again")
    (tmp_path / "summary.json").write_text("[1]")
    refused(tmp_path, "summary.json", "Run the scene again")


def test_a_summary_without_a_figure_is_refused(copy: Path) -> None:
    summary = json.loads((copy / "summary.json").read_text())
    del summary["energy"]
    (copy / "summary.json").write_text(json.dumps(summary))
    refused(copy, "summary.json", "no energy in it")


def test_other_columns_are_refused(copy: Path) -> None:
    table = copy / "energy.csv"
    table.write_text(table.read_text().replace("kinetic", "potential", 1))
    refused(copy, "energy.csv", "potential")


def test_text_among_the_numbers_is_refused(copy: Path) -> None:
    table = copy / "energy.csv"
    table.write_text(table.read_text().replace("\n0.01,", "\nsoon,"))
    refused(copy, "energy.csv", "column time")


def refused(folder: Path, *texts: str) -> None:
    with pytest.raises(OutputError) as caught:
        report(folder)
    for text in texts:
        assert text in str(caught.value)


def example(dimension: int) -> Fields:
    """One cell with its middle nodes, and numbers that tell every entry from every other."""
    corners = np.vstack([np.zeros(dimension), np.eye(dimension)])
    edges = {2: [(0, 1), (1, 2), (0, 2)], 3: [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]}[dimension]
    points = np.vstack([corners, *(corners[list(edge)].mean(axis=0) for edge in edges)])
    numbers = np.arange(points.size, dtype=float).reshape(points.shape)
    return Fields(points, np.arange(len(points))[None], numbers, 100.0 + numbers[:, 0])


@pytest.mark.parametrize("dimension", [2, 3])
def test_fields_come_back(tmp_path: Path, dimension: int) -> None:
    fields = example(dimension)
    write_vtu(tmp_path / "fields.vtu", fields)
    back = read_vtu(tmp_path / "fields.vtu")
    for name in ("points", "cells", "velocity", "pressure"):
        np.testing.assert_array_equal(getattr(back, name), getattr(fields, name))


@pytest.mark.parametrize("dimension", [2, 3])
def test_meshio_reads_the_same_fields(tmp_path: Path, dimension: int) -> None:
    meshio = pytest.importorskip("meshio")
    fields = example(dimension)
    write_vtu(tmp_path / "fields.vtu", fields)
    read = meshio.read(tmp_path / "fields.vtu")
    np.testing.assert_array_equal(read.points[:, :dimension], fields.points)
    np.testing.assert_array_equal(read.cells_dict["triangle6" if dimension == 2 else "tetra10"], fields.cells)
    np.testing.assert_array_equal(read.point_data["velocity"][:, :dimension], fields.velocity)
    np.testing.assert_array_equal(read.point_data["pressure"], fields.pressure)
    assert read.point_data["vorticity"].shape == (len(fields.points), *([] if dimension == 2 else [3]))


def test_series_lists_the_output_times(fall: Path) -> None:
    series = read_pvd(fall / "fields.pvd")
    assert [time for time, _ in series] == pytest.approx([0.0, 0.01, 0.02, 0.03])
    assert all(path.exists() for _, path in series)


def test_the_report_of_a_run_in_progress_says_so(tmp_path: Path) -> None:
    pages: list[str] = []

    def look(now: Progress) -> None:
        if now.time > 0.01 and not pages:
            pages.append(unescape(report(tmp_path)[-1].read_text(encoding="utf-8")))

    ball = {"type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.4, 0.5]}
    run(scene_from_dict(dry_tables(ball, end=0.03, output={"every": 0.01})), tmp_path, progress=look)
    assert "Status: goes on, at 0.0" in pages[0]
    assert "Results until " in pages[0]
    assert "Status: complete" in unescape(report(tmp_path)[-1].read_text(encoding="utf-8"))


def test_energies_show_what_dampers_take_and_the_legend_is_whole(tmp_path: Path) -> None:
    spring = {"stiffness": [0.0, 50.0], "damping": [0.0, 5.0]}
    ball = {"type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.4, 0.5], "spring": spring}
    scene = dry_tables(ball | {"velocity": [0.0, 1.0]}, end=0.03, output={"every": 0.01})
    run(scene_from_dict(scene), tmp_path)
    results = read_results(tmp_path)
    assert results.energy["contact_loss"][-1] > 0.0
    with matplotlib.rc_context(STYLE):
        figure = energy_plot(results)
        figure.canvas.draw()
    (legend,) = figure.legends
    shown, whole = legend.get_window_extent(), figure.bbox
    assert "taken by dampers" in [text.get_text() for text in legend.get_texts()]
    assert shown.x0 >= whole.x0
    assert shown.x1 <= whole.x1
    page = unescape(report(tmp_path)[-1].read_text(encoding="utf-8"))
    assert "taken by dampers of contacts and joints" in page
