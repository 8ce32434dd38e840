"""A backend goes on from another one's checkpoint."""

import numpy as np
import pytest
from falling import falling_disk

import rigidfluid
from rigidfluid.errors import OutputError

TWIN = """
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.hookspecs import hookimpl


class Twin(ScikitFem):
    name = "twin"


@hookimpl
def rigidfluid_fluid_backends():
    return [Twin]
"""
"""Another backend that writes the same states."""


@pytest.fixture(params=["twin", "ngsolve"])
def other(request, install):
    if request.param == "twin":
        install(TWIN, name="twin", module="twin_backend")
    else:
        pytest.importorskip("ngsolve")
        pytest.importorskip("rigidfluid_ngsolve")
    return request.param


def fall(end, backend, **fluid):
    return falling_disk(
        fluid={"backend": backend, "tolerance": 1e-12} | fluid,
        time={"step": 0.004, "end": end},
        mesh={"size": 0.4, "size_body": 0.08},
        output={"every": 0.02},
    )


def test_another_backend_of_the_same_elements_goes_on(tmp_path, other):
    alone = rigidfluid.run(fall(0.04, "scikit-fem"))
    rigidfluid.run(fall(0.02, "scikit-fem", solver="lu"), tmp_path / "out")
    both = rigidfluid.run(fall(0.04, other), tmp_path / "out", resume=True)
    assert both.summary["scene"]["fluid"]["backend"] == other
    for table in ("bodies", "energy"):
        for name, column in alone.table(table).items():
            if column.dtype.kind == "f":
                np.testing.assert_allclose(both.table(table)[name], column, rtol=1e-7, atol=1e-8, err_msg=name)


def test_another_backend_takes_no_other_fluid(tmp_path, other):
    rigidfluid.run(fall(0.004, "scikit-fem"), tmp_path / "out")
    with pytest.raises(OutputError, match=r"a run of another scene \(other: fluid\)"):
        rigidfluid.run(fall(0.008, other, viscosity=0.3), tmp_path / "out", resume=True)
