"""Runs in fluids whose viscosity varies: their ledger, resumption, and the scenes that are refused."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from scenes import wet_tables

import rigidfluid
from rigidfluid.api import Simulation, model_of, scene_from_dict
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.core.setup.features import features
from rigidfluid.errors import PluginError, RigidfluidError, SceneError, StepError
from rigidfluid.post.reports import report
from rigidfluid.post.reports.lines import speed_plot
from rigidfluid.post.reports.results import read_results

DISK = {"type": "sphere", "radius": 0.12, "position": [0.5, 0.6], "density": 3.0}
CARREAU = {
    "type": "carreau",
    "viscosity": 0.2,
    "viscosity_infinite": 0.01,
    "relaxation_time": 1.0,
    "exponent": 0.4,
}
BINGHAM = {"type": "bingham", "viscosity": 0.05, "yield_stress": 0.1, "stress_growth": 5.0}


def tables(material, model="navier-stokes", **changes):
    """A disk that falls in a box, twice as dense as the fluid."""
    given = wet_tables(DISK, end=0.2, step=0.02, fluid={"gravity": [0.0, -4.0], "model": model}, **changes)
    if material is not None:
        del given["fluid"]["viscosity"]
        given["fluid"]["material"] = material
    return given


@pytest.mark.parametrize("material", [CARREAU, BINGHAM], ids=["carreau", "bingham"])
@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
def test_the_ledger_closes_as_in_a_newtonian_fluid(material, model):
    ledgers = []
    for each in (material, None):
        it = Simulation(scene_from_dict(tables(each, model)))
        it.go()
        ledgers.append(it.state.ledger)
    assert ledgers[0].dissipation > 0.0
    assert abs(ledgers[0].dissipation / ledgers[1].dissipation - 1.0) > 0.02
    assert abs(ledgers[0].relative_residual) < 1.5 * abs(ledgers[1].relative_residual) + 1e-4


def test_an_expression_flows_as_the_material_that_it_writes_out():
    """CARREAU, whose time is 1 and exponent .4."""
    flows = []
    for material in (CARREAU, formula("0.01 + 0.19*(1 + shear_rate**2)**-0.3")["material"]):
        it = Simulation(scene_from_dict(tables(material)))
        it.go(0.06)
        flows.append(it.state.twist.velocity[0])
    assert flows[0] == pytest.approx(flows[1], rel=1e-9)


def test_a_resumed_run_goes_on_with_the_same_bits(tmp_path):
    given = tables(CARREAU, output={"every": 0.1})
    rigidfluid.run(scene_from_dict(given), tmp_path / "whole")
    rigidfluid.run(scene_from_dict(given | {"time": {"end": 0.1, "step": 0.02}}), tmp_path / "resumed")
    rigidfluid.run(scene_from_dict(given), tmp_path / "resumed", resume=True)
    for name in ("bodies.csv", "energy.csv"):
        assert (tmp_path / "resumed" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_a_body_falls_faster_in_what_thins():
    """Than in a fluid with the viscosity at rest, and slower than in one with that at high shear rates."""
    speeds = []
    for viscosity, material in ((0.2, None), (None, CARREAU), (0.01, None)):
        given = tables(material)
        if viscosity is not None:
            given["fluid"]["viscosity"] = viscosity
        it = Simulation(scene_from_dict(given))
        it.go()
        speeds.append(-it.state.twist.velocity[0, 1])
    assert speeds == sorted(speeds)
    assert speeds[1] > 1.05 * speeds[0]


@pytest.mark.parametrize(
    "material", [pytest.param(CARREAU, marks=pytest.mark.long), BINGHAM], ids=["carreau", "bingham"]
)
def test_the_viscosity_is_in_fields_files_and_report(material, tmp_path):
    it = Simulation(scene_from_dict(tables(material, output={"every": 0.04})), tmp_path)
    it.go(0.04)
    found, read = it.fields(), rigidfluid.load_results(tmp_path).fields()
    it.close()
    expected = it.system.fluid.material.viscosity(found.shear_rate)
    assert np.ptp(expected) > 0.01
    np.testing.assert_array_equal(found.viscosity, expected)
    np.testing.assert_allclose(read.viscosity, expected, rtol=1e-6)
    written = ET.parse(tmp_path / "fields" / "000001.vtu").iter("DataArray")
    assert {"viscosity", "shear_rate"} < {array.get("Name") for array in written}
    report(tmp_path)
    assert (tmp_path / "report" / "viscosity.png").exists()
    assert ("yield stress" in (tmp_path / "report.html").read_text()) == (material is BINGHAM)


def test_the_report_draws_the_reynolds_number_of_the_summary(tmp_path):
    rigidfluid.run(scene_from_dict(tables(CARREAU)), tmp_path)
    results = read_results(tmp_path)
    (told,) = speed_plot(results).axes[1].texts
    assert told.get_text() == f"highest {results.summary['reynolds']:.4g}"


def test_one_viscosity_has_no_field(tmp_path):
    given = tables(None)
    given["fluid"]["viscosity"] = 0.1
    assert Simulation(scene_from_dict(given)).fields().viscosity is None


def formula(viscosity):
    return {"material": {"type": "expression", "viscosity": viscosity}}


REFUSED = {
    "both": ({"viscosity": 0.1}, "fluid.viscosity: found 0.1 and a material; allowed is one of both"),
    "no fluid": ({"backend": "dry"}, "fluid.material: found 'carreau' with backend 'dry'"),
    "misspelt type": ({"material": CARREAU | {"type": "careau"}}, "Did you mean 'carreau'"),
    "other word": ({"material": CARREAU | {"type": "carreau-yasuda"}}, "Did you mean 'carreau'"),
    "no type": ({"material": {"viscosity": 0.1}}, "fluid.material.type"),
    "misspelt key": ({"material": CARREAU | {"exponents": 0.4}}, "fluid.material.exponents.*exponent"),
    "missing key": ({"material": {"type": "carreau", "viscosity": 0.1}}, "fluid.material.relaxation_time"),
    "negative": ({"material": CARREAU | {"viscosity": -1.0}}, "fluid.material.viscosity"),
    "formula of place": (formula("0.1 + x"), "fluid.material.viscosity: found an unknown name: 'x'"),
    "formula of time": (formula("0.1 + t"), "fluid.material.viscosity: .* numbers, shear_rate, pi, "),
    "infinite at rest": (formula("1/shear_rate"), "fluid.material.viscosity: found inf at rest"),
    "key of another": ({"material": CARREAU | {"yield_stress": 1.0}}, "fluid.material.yield_stress"),
}


@pytest.mark.parametrize(("fluid", "found"), REFUSED.values(), ids=REFUSED)
def test_wrong_tables_are_refused(fluid, found):
    given = tables(CARREAU)
    given["fluid"] |= fluid
    with pytest.raises((SceneError, PluginError), match=found):
        Simulation(scene_from_dict(given))


@pytest.mark.parametrize("formula", ["0.1 - shear_rate", "sqrt(0.1 - shear_rate)", "1/(shear_rate < 0.1)"])
def test_an_expression_that_fails_at_a_shear_rate_is_told_with_it(formula):
    it = Simulation(scene_from_dict(tables({"type": "expression", "viscosity": formula})))
    with pytest.raises(StepError, match=r"fluid\.material\.viscosity.*at a shear rate of .*shear_rate"):
        it.go()


def test_a_backend_for_newtonian_fluids_refuses_others(monkeypatch):
    monkeypatch.setattr(ScikitFem, "materials", (Newtonian,))
    with pytest.raises(
        RigidfluidError, match=r"fluid\.material: found Carreau with backend 'scikit-fem'; allowed is Newt"
    ):
        Simulation(scene_from_dict(tables(CARREAU)))


@pytest.mark.parametrize(
    ("material", "told"), [(CARREAU, (True, "material 'carreau'")), (None, (False, "material 'newtonian'"))]
)
def test_check_tells_the_material(material, told):
    system = assemble(model_of(scene_from_dict(tables(material))))
    found = {feature.name: (feature.on, feature.why) for feature in features(system, None)}
    assert found["viscosity that varies"] == told


def test_steps_are_expected_to_cost_twice_as_much():
    costs = []
    for material in (CARREAU, None):
        backend = Simulation(scene_from_dict(tables(material))).system.backend
        costs.append(backend.solver_cost(1000.0, 100.0))
    assert costs[0].step_seconds == 2.0 * costs[1].step_seconds
    assert costs[0].memory == costs[1].memory


@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
def test_a_steady_flow_at_the_start_stays_as_it_is(model):
    """Past a fixed disk, in a fluid that thins."""
    given = tables(CARREAU, model, boundary=[{"on": "left", "type": "velocity", "velocity": ["4*y*(1-y)", "0"]}])
    given["fluid"] |= {"initial": "steady", "gravity": [0.0, 0.0]}
    given["body"] = [DISK | {"fixed": True}]
    given["boundary"].append({"on": "right", "type": "pressure", "pressure": 0.0})
    it = Simulation(scene_from_dict(given))
    before = it.fields().velocity
    it.step()
    it.step()
    assert abs(it.fields().velocity - before).max() < 1e-6 * abs(before).max()
