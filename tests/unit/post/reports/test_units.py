"""Names of units in labels: composed from those of length, time and mass, in 2D per depth."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path

import pytest
from paths import SCENES
from scenes import dry_tables

import rigidfluid
from rigidfluid.errors import SceneError
from rigidfluid.post.reports import report
from rigidfluid.post.reports.lines import force_plot
from rigidfluid.post.reports.results import read_results
from rigidfluid.post.reports.scale import Scale
from rigidfluid.post.reports.style import new_figure
from rigidfluid.post.reports.units import Units

BALL = {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.5, 0.5]}
CGS = {"length": "cm", "time": "s", "mass": "g"}
QUANTITIES = {
    "length": ("cm", "cm"),
    "time": ("s", "s"),
    "length/time": ("cm/s", "cm/s"),
    "1/time": ("1/s", "1/s"),
    "rad/time": ("rad/s", "rad/s"),
    "force": ("g/s²", "g·cm/s²"),
    "force·length": ("g·cm/s²", "g·cm²/s²"),
    "energy": ("g·cm/s²", "g·cm²/s²"),
    "scalar·area/time": ("scalar·cm²/s", "scalar·cm²/s"),
}
"""Units of quantities in 2D, per depth, and in 3D: dyn/cm and dyn, erg/cm and erg."""


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("dimension", [2, 3])
def test_units_are_composed(quantity: str, dimension: int) -> None:
    units = Units(CGS, dimension)
    assert units.put_into(f"this\n[{quantity}] and that") == f"this\n[{QUANTITIES[quantity][dimension - 2]}] and that"
    assert Units(None, dimension).put_into(f"[{quantity}]") == f"[{quantity}]"


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_unit_of_pressure_is_the_same_in_2d_and_3d(dimension: int) -> None:
    for quantity, unit in (("speed", "cm/s"), ("vorticity", "1/s"), ("pressure", "g/(cm·s²)")):
        figure = new_figure(3.0, 3.0)
        Scale(quantity, -1.0, 1.0, 1.0).draw_bar(figure, [figure.subplots()], dimension)
        Units(CGS, dimension).put_into_labels(figure)
        assert figure.axes[-1].get_ylabel() == f"{quantity} [{unit}]"


@pytest.mark.parametrize(
    "text", ["wall time [s]", "[% of what was at hand]", "peak memory [MB]", "[rad]", "a[0]", "[]"]
)
def test_other_brackets_are_left(text: str) -> None:
    assert Units(CGS, 2).put_into(text) == text


def named(units: object) -> rigidfluid.Scene:
    tables = dry_tables(BALL, end=0.02, fluid={"gravity": [0.0, -1.0]}, output={"every": 0.01})
    tables["scene"] |= {} if units is None else {"units": units}
    return rigidfluid.scene_from_dict(tables)


@pytest.mark.long
def test_results_are_the_same_and_labels_are_not(tmp_path: Path) -> None:
    for name, units in (("plain", None), ("named", CGS)):
        rigidfluid.run(named(units), tmp_path / name)
        report(tmp_path / name)
    plain, other = (tmp_path / name for name in ("plain", "named"))
    for table in sorted(plain.glob("*.csv")):
        assert table.read_bytes() == (other / table.name).read_bytes()
    labels = [force_plot_labels(folder) for folder in (plain, other)]
    assert labels == [["x-force [force]", "y-force [force]"], ["x-force [g/s²]", "y-force [g/s²]"]]
    pages = [unescape((folder / "report.html").read_text(encoding="utf-8")) for folder in (plain, other)]
    assert ("kinetic, at the end [energy]" in pages[0], "kinetic, at the end [g·cm/s²]" in pages[1]) == (True, True)
    assert "[time]\nend" in pages[1]
    assert (plain / "report/force.png").read_bytes() != (other / "report/force.png").read_bytes()


def force_plot_labels(folder: Path) -> list[str]:
    results = read_results(folder)
    figure = results.units.put_into_labels(force_plot(results))
    return [axes.get_ylabel() for axes in figure.axes if axes.get_ylabel()]


def test_a_run_goes_on_with_other_names_of_units(tmp_path: Path) -> None:
    rigidfluid.run(named(None), tmp_path)
    tables = named(CGS).to_dict()
    tables["time"]["end"] = 0.04
    rigidfluid.run(rigidfluid.scene_from_dict(tables), tmp_path, resume=True)
    results = read_results(tmp_path)
    assert results.time[-1] == pytest.approx(0.04)
    assert results.units.put_into("[length]") == "[cm]"


@pytest.mark.parametrize("wrong", [{"length": "cm"}, CGS | {"time": "[s]"}, CGS | {"mass": ""}, CGS | {"force": "N"}])
def test_names_that_are_no_units_are_refused(wrong: dict[str, str]) -> None:
    with pytest.raises(SceneError, match=r"scene\.units"):
        named(wrong)


@pytest.mark.parametrize(("names", "title"), [(None, "time 0.04, gap 0.002"), (CGS, "time 0.04 s, gap 0.002 cm")])
def test_titles_have_units_after_their_numbers(names: dict[str, str] | None, title: str) -> None:
    figure = new_figure(2.0, 2.0)
    figure.add_subplot(title="time 0.04 [time], gap 0.002 [length]")
    (axes,) = Units(names, 2).put_into_labels(figure).axes
    assert axes.get_title() == title


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.toml")), ids=lambda path: path.stem)
def test_scenes_name_the_units_that_their_comments_tell(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    comment = " ".join(line.removeprefix("# ") for line in text.partition("\n[")[0].splitlines())
    told = re.search(r"(?:Units:|in) (\w+), (\w+), s\.", comment)
    units = rigidfluid.load_scene(path).scene.units
    assert (None if units is None else (units.length, units.mass, units.time)) == (told and (*told.groups(), "s"))
