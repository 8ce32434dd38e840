"""200 spheres in a box, here and in LAMMPS; docs/validation/lammps.md has the figures."""

from __future__ import annotations

import pytest
from dry_scenes import sphere_gas

from rigidfluid_lammps import CrosscheckError, crosscheck
from rigidfluid_lammps.library import lammps_session


@pytest.fixture(autouse=True, scope="module")
def lammps() -> None:
    try:
        with lammps_session():
            return
    except CrosscheckError as error:
        pytest.skip(str(error))


@pytest.mark.validation
def test_trajectories_agree_at_the_order_of_the_integrator() -> None:
    rows = crosscheck(sphere_gas(1_000), steps=4).rows
    for row in rows:
        assert row.parted is None
        assert row.position < 1e-8
        assert row.energy < 1e-8
        assert row.momentum < 1e-8
    assert rows[0].from_finest / rows[2].from_finest > 2.0**3.5


@pytest.mark.validation
def test_means_agree_when_chaos_has_parted_the_trajectories() -> None:
    (row,) = crosscheck(sphere_gas(100_000), steps=1, samples=2_000).rows
    assert row.parted is not None
    assert row.parted > 0.4
    assert row.ours.energy == pytest.approx(row.theirs.energy, rel=1e-4)
    # some 1,500 of the collisions with walls are seen, and the total momentum forgets itself 20 times
    assert row.ours.pressure == pytest.approx(row.theirs.pressure, rel=0.08)
    assert row.ours.momentum == pytest.approx(row.theirs.momentum, rel=0.4)
