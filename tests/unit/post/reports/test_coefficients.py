"""Drag, lift and periods in reports: against published figures and made-up signals."""

from __future__ import annotations

from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from falling import SCENES, falling_disk
from scenes import dry_tables

import rigidfluid
from rigidfluid.post.reports import report
from rigidfluid.post.reports.coefficient_plot import coefficient_caption, coefficient_plot
from rigidfluid.post.reports.coefficients import coefficients, figures, reference
from rigidfluid.post.reports.contact_plot import contact_plot
from rigidfluid.post.reports.periods import frequency
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.rotation_plot import rotation_plot, torque_plot, turned, turning

TIME = np.linspace(0.0, 20.0, 801)


@pytest.mark.parametrize("rate", [0.45, 1.7])
def test_a_steady_swing_has_a_frequency(rate: float) -> None:
    values = 3.0 + 0.2 * np.sin(2 * np.pi * rate * TIME + 1.0) + np.exp(-TIME)
    assert frequency(TIME, values, 0.1) == pytest.approx(rate, rel=2e-3)


@pytest.mark.parametrize(
    "values",
    [
        np.full_like(TIME, 3.0),
        3.0 + 0.1 * TIME,
        np.sin(2 * np.pi * 0.2 * TIME),
        np.exp(-0.3 * TIME) * np.sin(2 * np.pi * TIME),
        0.09 * np.sin(2 * np.pi * TIME),
        np.sin(0.2 * np.pi * TIME**2 / 10),
        np.random.default_rng(0).normal(size=TIME.size),
        np.where(TIME > 15, np.inf, np.sin(2 * np.pi * TIME)),
    ],
    ids=["constant", "drift", "two periods", "fading", "too little", "ever faster", "noise", "not known"],
)
def test_what_is_no_steady_swing_has_none(values: np.ndarray) -> None:
    assert frequency(TIME, values, 0.1) is None


@pytest.fixture(scope="module")
def dfg(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Schäfer and Turek's steady case 2D-1 from the steady flow, with coarse cells."""
    folder = tmp_path_factory.mktemp("dfg")
    coarse = ["mesh.size=0.06", "mesh.size_body=0.008", "time.end=0.4", "output.every=0.4", "fluid.initial=steady"]
    rigidfluid.run(rigidfluid.load_scene(SCENES / "dfg_cylinder.toml", coarse), folder)
    return folder


def test_drag_and_lift_of_the_steady_cylinder_are_the_published_ones(dfg: Path) -> None:
    """c_D = 5.5795, c_L = .01062, with U the mean at the inlet, .2, and D = .1."""
    results = read_results(dfg)
    by = reference(results)
    assert by is not None
    assert by.speed == pytest.approx(0.2, rel=1e-3)
    np.testing.assert_allclose(by.axes, np.eye(2), atol=1e-15)
    (found,) = figures(results, by)
    assert found.drag == pytest.approx(5.5795, rel=5e-3)
    assert found.lift == pytest.approx(0.01062, rel=0.15)
    assert found.strouhal is None


def test_a_page_tells_of_drag_and_lift(dfg: Path) -> None:
    report(dfg)
    page = unescape((dfg / "report.html").read_text(encoding="utf-8"))
    assert "U = 0.2 is the greatest mean velocity of an inlet" in page
    assert "no period" in page
    assert (dfg / "report" / "coefficients.png").exists()


def read_back(scene: Any, folder: Path) -> Results:
    rigidfluid.run(scene, folder)
    return read_results(folder)


MESH, STEPS = {"size": 0.4, "size_body": 0.1}, {"end": 0.03, "step": 0.01}


def test_a_body_that_falls_has_no_coefficients(tmp_path: Path) -> None:
    results = read_back(falling_disk(mesh=MESH, time=STEPS, output={"every": 0.03}), tmp_path)
    assert np.abs(results.bodies["vy"]).max() > 0.0
    assert reference(results) is None


@pytest.mark.parametrize("way", [(0.5, 0.0), (0.0, -0.5)])
def test_coefficients_of_a_towed_body_go_by_its_prescribed_speed(way: tuple[float, float], tmp_path: Path) -> None:
    tables = falling_disk(mesh=MESH, time=STEPS, output={"every": 0.03}).to_dict()
    tables["body"][0]["prescribed"] = {"velocity": list(way)}
    results = read_back(rigidfluid.scene_from_dict(tables), tmp_path)
    by = reference(results)
    assert by is not None
    along = -np.array(way) / 0.5
    np.testing.assert_allclose(by.axes, [along, [-along[1], along[0]]], atol=1e-15)
    assert by.speed == pytest.approx(0.5)
    drag = coefficients(results, by)[-1, 0, 0]
    force = np.array([results.bodies[name][-1, 0] for name in ("fx", "fy")])
    assert drag == pytest.approx(force @ along / (0.5 * 0.5**2 * 0.25))
    assert drag > 0.0
    assert "the greatest prescribed speed of a body" in coefficient_caption(by, 2)
    assert len(coefficient_plot(results, by).axes) == 2


def tumbling(dimension: int) -> dict[str, Any]:
    """An ellipsoid that spins about one axis of space, and a ball that does not; no fluid."""
    still = [0.0] * dimension
    spin = [2.0] if dimension == 2 else [0.0, 0.0, 2.0]
    ellipsoid = {"type": "ellipsoid", "semi_axes": [0.3, *[0.1] * (dimension - 1)], "angular_velocity": spin}
    ball = {"type": "sphere", "radius": 0.1, "position": [2.0, *still[1:]]}
    return dry_tables(
        {"density": 1.0} | ellipsoid | {"position": still},
        {"density": 1.0} | ball,
        step=0.1,
        domain={"lower": [-3.0] * dimension, "upper": [3.0] * dimension},
    )


@pytest.mark.parametrize("dimension", [2, 3])
def test_bodies_that_turn_are_shown(dimension: int, tmp_path: Path) -> None:
    results = read_back(rigidfluid.scene_from_dict(tumbling(dimension)), tmp_path)
    assert turning(results).tolist() == [True, False]
    np.testing.assert_allclose(turned(results)[:, 0], 2.0 * results.time, atol=1e-7)
    figure = rotation_plot(results)
    assert len(figure.axes) == {2: 2, 3: 4}[dimension]
    assert all(len(axes.lines) == 1 for axes in figure.axes)
    np.testing.assert_allclose(figure.axes[-1].lines[0].get_ydata(), 2.0)
    assert len(torque_plot(results).axes) == {2: 2, 3: 6}[dimension]
    assert reference(results) is None


def test_contacts_over_time(tmp_path: Path) -> None:
    results = read_back(rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=0.01"]), tmp_path)
    reach = max(results.system.law.ranges)
    np.testing.assert_array_equal(results.contact_counts > 0, results.bodies["gap"].min(axis=1) < reach)
    assert results.contact_counts.any()
    assert results.contact_counts[0] == 0
    count, force, gap = contact_plot(results).axes
    np.testing.assert_array_equal(count.lines[0].get_ydata(), results.contact_counts)
    assert max(force.lines[0].get_ydata()) > 0.0
    np.testing.assert_array_equal(gap.lines[0].get_ydata(), results.bodies["gap"].min(axis=1))
