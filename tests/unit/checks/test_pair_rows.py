"""The table of pairs: Stokes number, gaps, friction and restitution of each kind of pair, worked out by hand."""

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from extreme_scenes import wet
from typer.testing import CliRunner

from rigidfluid.checks import check
from rigidfluid.cli import app

RADIUS, DENSITY, VISCOSITY, RANGE = 0.125, 3.0, 0.1, 0.0125
LAW = {"law": "normal", "range": RANGE, "epsilon": 1e-4}
DASHPOT = {"law": "spring-dashpot", "range": RANGE, "stiffness": 1e4, "restitution": 0.7}


def pairs_of(contact, mesh=None):
    body = ball([0.5, 0.5, 0.22], [0.0, 0.0, -20.0], density=DENSITY, radius=RADIUS)
    return check(wet(contact, body, end=0.06, step=0.004, mesh=mesh)).pairs


def stokes_number(speed):
    return (DENSITY + 0.5) * 2.0 * RADIUS * speed / (9.0 * VISCOSITY)


def test_a_rough_ball_rebounds_as_a_dry_one_behind_its_film():
    (row,) = pairs_of(LAW | {"restitution": 0.9, "roughness": 1e-4})
    stokes, taken = stokes_number(row.speed), np.log(RADIUS / 1e-4)
    assert row.stokes_number == pytest.approx(stokes)
    assert stokes > taken
    assert row.rebound == pytest.approx((0.9 * (stokes - taken) - taken) / stokes)
    assert (row.names, row.count, row.laws) == (("body0", "left"), 1, ("normal",))
    assert (row.range, row.roughness, row.friction, row.restitution) == (RANGE, 1e-4, "none", 0.9)


def test_the_formula_of_stokes_numbers_gives_the_rebound_where_it_is_asked_for():
    (row,) = pairs_of(LAW | {"restitution": 0.9, "restitution_stokes": 35.0})
    assert row.rebound == pytest.approx(0.9 * np.exp(-35.0 / stokes_number(row.speed)))
    assert row.roughness is None


def test_the_film_ends_where_it_is_as_wide_as_the_finest_cell():
    (coarse,), (fine,) = (pairs_of(LAW, {"size_body": 0.16, "refinements": number}) for number in (1, 2))
    assert coarse.resolved == pytest.approx(0.08**2 / RADIUS)
    assert fine.resolved == pytest.approx(0.04**2 / RADIUS)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({}, "none"),
        ({"friction": 0.3}, "sliding, μ 0.3"),
        ({"friction": 0.3, "tangential_stiffness": 1e3}, "static and sliding, μ 0.3"),
    ],
)
def test_friction_is_told(keys, words):
    (row,) = check(dry_scene(DASHPOT | keys, ball([0.5, 0.2], [0.0, -1.0]), end=1.0, step=0.01)).pairs
    assert row.friction == words
    assert (row.restitution, row.rebound) == (0.7, 0.7)
    assert (row.stokes_number, row.resolved) == (None, None)


def test_pairs_of_a_kind_are_counted():
    balls = [ball([0.2 * number, 0.5], [0.0, -1.0], radius=0.05) for number in range(1, 5)]
    large = ball([0.5, 0.8], [0.0, -1.0], radius=0.1)
    rows = check(dry_scene(LAW, *balls, large, end=1.0, step=0.01)).pairs
    assert sorted(row.count for row in rows) == [1, 4, 4, 6]


def test_the_command_prints_a_row_for_each_kind():
    shown = CliRunner(env={"COLUMNS": "160"}).invoke(app, ["check", "scenes/rebound.toml"]).output
    row = next(line for line in shown.splitlines() if "disk and" in line and "│" in line)
    assert "0.8" in row
    assert "Stokes number" in shown
