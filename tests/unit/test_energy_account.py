"""Energy created and lost, as made-up ledgers tell it."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid.core.output.energy_account import contacts_pushed, energy_account, energy_warnings, per_cent
from rigidfluid.core.output.records import LEDGER_COLUMNS

PUT_IN = 10.0
QUIET = np.zeros(6, dtype=bool)
BLOW = np.array([False, False, False, True, False, False])


def table(**columns):
    """Six states of a body thrown with an energy of 10; the residual follows from the other columns."""
    energy = {name: np.zeros(6) for name in LEDGER_COLUMNS}
    energy["kinetic"] = np.full(6, PUT_IN)
    energy |= {name: np.array(values, dtype=float) for name, values in columns.items()}
    stored = energy["kinetic"] + energy["contact"]
    incoming = energy["gravity"] + energy["boundary"] + energy["control"]
    outgoing = energy["dissipation"] + energy["contact_loss"] + energy["transfer_loss"]
    energy["residual"] = incoming - outgoing - (stored - stored[0])
    return energy


def test_a_balance_that_closes():
    account = energy_account(table(kinetic=[10, 9, 8, 7, 6, 5], dissipation=[0, 1, 2, 3, 4, 5]))
    assert (account.put_in, account.created, account.lost, account.unaccounted) == (PUT_IN, 0.0, 0.0, 0.0)


def test_dissipation_hides_nothing_that_was_created():
    energy = table(kinetic=[10, 9, 8, 7.3, 6.3, 5], dissipation=[0, 1, 2, 3, 4, 5])
    account = energy_account(energy)
    assert account.created == pytest.approx(0.03)
    assert account.lost == pytest.approx(0.0)
    assert account.unaccounted == pytest.approx(0.0), "it came and went"


def test_the_first_step_is_left_out():
    account = energy_account(table(kinetic=[10, 12, 12, 12.2, 12, 11.9]))
    assert account.created == pytest.approx(0.02)
    assert account.lost == pytest.approx(0.01)
    assert account.unaccounted == pytest.approx(-0.19)


def test_friction_of_impacts_explains_a_loss():
    energy = table(kinetic=[10, 10, 10, 8, 8, 8], path_friction=[0, 0, 0, 1.5, 1.5, 1.5])
    account = energy_account(energy)
    assert account.lost == pytest.approx(0.05)
    assert account.path_friction == pytest.approx(0.15)
    assert account.unaccounted == pytest.approx(0.2)


def test_friction_of_impacts_neither_explains_nor_makes_what_was_created():
    account = energy_account(table(kinetic=[10, 10, 10, 10.3, 10.3, 10.3], path_friction=[0, 0, 0, 1, 1, 1]))
    assert account.created == pytest.approx(0.03)
    assert account.lost == 0.0


def test_what_is_put_in():
    energy = table(
        kinetic=np.full(6, 1.0),
        contact=np.full(6, 2.0),
        gravity=[0, 3, 4, 1, -1, -5],
        boundary=[0, 1, 2, 3, 4, 5],
        control=[0, 1, 4, 1, 0, -3],
    )
    assert energy_account(energy).put_in == 1.0 + 2.0 + 4.0 + 6.0


@pytest.mark.parametrize("states", [1, 2, 6])
def test_where_nothing_was_put_in(states):
    energy = {name: values[:states] for name, values in table(kinetic=np.zeros(6)).items()}
    account = energy_account(energy)
    assert (account.put_in, account.created, account.lost, account.unaccounted, account.path_friction) == (0.0,) * 5
    assert energy_warnings(energy, QUIET[:states]) == []


def test_a_run_that_stopped_in_its_first_step():
    energy = {name: values[:1] for name, values in table().items()}
    assert energy_account(energy).created == 0.0


def after_blow(change):
    return [10, 10, 10, 10 + change, 10 + change, 10 + change]


@pytest.mark.parametrize(
    ("energy", "pushed", "texts"),
    [
        (table(kinetic=after_blow(0.3)), BLOW, ["3 % of the energy put in came from nowhere, probably at impacts"]),
        (table(kinetic=after_blow(0.3)), np.roll(BLOW, -1), ["probably at impacts"]),
        (table(kinetic=after_blow(0.3)), np.roll(BLOW, 1), ["probably because time.step is too long or the mesh"]),
        (table(kinetic=after_blow(-0.3)), BLOW, ["3 % of the energy put in vanished, probably at impacts"]),
        (table(kinetic=after_blow(-0.3)), QUIET, ["vanished, probably because time.step is too long or the mesh"]),
        (
            table(kinetic=[10, 10, 10, 9.1, 9.1, 9.1], transfer_loss=[0, 0, 0, 0.4, 0.4, 0.4]),
            QUIET,
            ["5 % of the energy put in vanished, probably in re-meshing"],
        ),
        (table(kinetic=after_blow(-1.0), path_friction=[0, 0, 0, 0, 0.5, 0.5]), QUIET, ["probably at impacts"]),
        (table(kinetic=[10, 10, 10, 9.8, 10.8, 10.8]), QUIET, ["came from nowhere", "vanished"]),
        (table(kinetic=after_blow(0.09)), BLOW, []),
    ],
)
def test_warnings_name_the_likely_cause(energy, pushed, texts):
    warnings = energy_warnings(energy, pushed)
    assert len(warnings) == len(texts)
    for warning, text in zip(warnings, texts, strict=True):
        assert text in warning.text
        assert "Shorten time.step" in warning.remedy


@pytest.mark.parametrize(("change", "serious"), [(0.2, False), (0.49, False), (0.51, True), (-0.49, False), (-2, True)])
def test_from_a_twentieth_on_a_warning_is_serious(change, serious):
    (warning,) = energy_warnings(table(kinetic=after_blow(change)), BLOW)
    assert warning.serious == serious
    assert ("do not rely on this run" in warning.text) == serious


def test_contacts_that_pushed():
    bodies = {"cfx": np.array([0, 0, 0, 0, 1.0, 0]), "cfy": np.array([0, 0, 0, -1.0, 0, 0]), "x": np.ones(6)}
    np.testing.assert_array_equal(contacts_pushed(bodies, 3), [False, True, True])


def test_per_cent():
    assert [per_cent(share) for share in (0, 1e-9, -0.0123, 0.05678, 1, 23.7)] == [
        "0 %", "0 %", "-1.2 %", "5.7 %", "100 %", "2370 %"
    ]  # fmt: skip
