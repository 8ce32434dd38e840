"""Energy created and lost, as made-up ledgers tell it."""

from __future__ import annotations

import numpy as np
import pytest
from made_up_energy import PUT_IN, table, warned

from rigidfluid.core.output.energy_account import energy_account, per_cent


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
        body_force=[0, 0, 2, 0, 0, 0],
    )
    assert energy_account(energy).put_in == 1.0 + 2.0 + 4.0 + 8.0


def test_where_little_was_put_in_shares_are_those_of_what_was_at_hand():
    """Bodies that attract each other speed up, and a tenth of it vanishes."""
    energy = table(kinetic=[0, 1, 2, 4, 4.5, 4.5], contact=[0, -1, -2, -4, -5, -5])
    account = energy_account(energy)
    assert (account.put_in, account.at_hand) == (0.0, 5.0)
    assert account.unaccounted == pytest.approx(0.1)


@pytest.mark.parametrize(("taken", "told"), [(0.4, 0), (0.6, 1)])
def test_much_that_stabilisation_takes_is_told(taken, told):
    warnings = warned(table(kinetic=after_blow(-taken), grad_div_loss=after_blow(taken, 0)))
    assert [warning.text for warning in warnings] == [
        "6 % of the energy put in was taken by stabilisation, in cells too coarse for the flow"
    ] * told


@pytest.mark.parametrize("states", [1, 2, 6])
def test_where_nothing_was_put_in(states):
    energy = {name: values[:states] for name, values in table(kinetic=np.zeros(6)).items()}
    account = energy_account(energy)
    assert (account.put_in, account.created, account.lost, account.unaccounted, account.path_friction) == (0.0,) * 5
    assert warned(energy) == []


def test_a_run_that_stopped_in_its_first_step():
    energy = {name: values[:1] for name, values in table().items()}
    assert energy_account(energy).created == 0.0


def blow(change, **parts):
    """Energy that changes in the third step, and then stays; each of the ``parts`` of that happens there."""
    return table(
        kinetic=after_blow(change), **{f"residual_{name}": after_blow(part, 0) for name, part in parts.items()}
    )


def after_blow(change, before=PUT_IN):
    return [before, before, before, before + change, before + change, before + change]


@pytest.mark.parametrize(
    ("energy", "text", "remedy"),
    [
        (
            blow(0.3),
            "3 % of the energy at hand came from nowhere between 0.2 and 0.3: 3 % by a time.step too long for the",
            "halve",
        ),
        (
            blow(0.3, contacts=-0.3),
            "came from nowhere between 0.2 and 0.3: 3 % at impacts, for which time.step is too long",
            "halve",
        ),
        (blow(-0.3, contacts=0.3), "3 % of the energy at hand vanished between 0.2 and 0.3: 3 % at impacts", "halve"),
        (
            blow(-0.3, mesh=0.3),
            "vanished between 0.2 and 0.3: 3 % through curved slip faces, for which the mesh is too coarse",
            "finer",
        ),
        (blow(-0.3, remeshing=0.3), "vanished between 0.2 and 0.3: 3 % by re-meshing", "mesh.remesh_every"),
        (
            blow(-0.4, mesh=0.3),
            "4 % of the energy at hand vanished between 0.2 and 0.3: 3 % through curved slip faces, for which",
            "finer",
        ),
        (
            blow(-0.4, mesh=0.1),
            "vanished between 0.2 and 0.3: 3 % by a time.step too long for the motion, 1 % through curved",
            "halve",
        ),
        (blow(-0.4, mesh=0.03), "vanished between 0.2 and 0.3: 3.7 % by a time.step too long for the motion", "halve"),
        (
            blow(-0.3, mesh=0.5, contacts=-0.2),
            "3 % of the energy at hand vanished between 0.2 and 0.3: 5 % through curved slip",
            "finer",
        ),
    ],
)
def test_a_warning_names_the_causes_with_their_figures(energy, text, remedy):
    (warning,) = warned(energy)
    assert text in warning.text
    assert remedy in warning.remedy


def test_small_causes_are_not_told():
    (warning,) = warned(blow(-0.4, mesh=0.03))
    assert "slip" not in warning.text


def test_what_re_meshing_took_has_vanished():
    energy = table(kinetic=[10, 10, 10, 9.6, 9.6, 9.6], transfer_loss=after_blow(0.4, 0))
    assert energy_account(energy).unaccounted == pytest.approx(0.0)
    assert energy_account(energy).lost == pytest.approx(0.04)
    (warning,) = warned(energy)
    assert "4 % of the energy at hand vanished between 0.2 and 0.3: 4 % by re-meshing" in warning.text


def test_what_re_meshing_made_came_from_nowhere():
    (warning,) = warned(table(kinetic=after_blow(0.4), transfer_loss=after_blow(-0.4, 0)))
    assert "4 % of the energy at hand came from nowhere between 0.2 and 0.3: 4 % by re-meshing" in warning.text


def test_friction_of_impacts_excuses_what_impacts_lost():
    energy = blow(-1.0, contacts=0.8) | {"path_friction": np.array(after_blow(0.7, 0))}
    assert "3 % of the energy at hand vanished between 0.2 and 0.3: 2 % by a time.step" in warned(energy)[0].text


def test_energy_may_come_and_vanish():
    came, vanished = warned(table(kinetic=[10, 10, 10, 9.8, 10.8, 10.8]))
    assert "came from nowhere" in came.text
    assert "vanished" in vanished.text


@pytest.mark.parametrize(("change", "told"), [(0.3, "came from nowhere"), (-0.3, "vanished")])
def test_a_bad_start_is_told(change, told):
    energy = table(kinetic=[10, *[10 + change] * 5], residual_start=[0, *[-change] * 5])
    (warning,) = warned(energy)
    assert f"3 % of the energy at hand {told} between 0 and 0.1: 3 % in first steps" in warning.text


def test_friction_of_impacts_leaves_energy_unaccounted_for():
    energy = blow(-0.6, contacts=0.6) | {"path_friction": np.array(after_blow(0.59, 0))}
    (warning,) = warned(energy)
    assert warning.serious
    assert "6 % of the energy put in is unaccounted for at the end: 6 % at impacts" in warning.text


def test_what_is_told_as_lost_is_not_told_again():
    assert len(warned(blow(-0.3))) == 1


@pytest.mark.parametrize("change", [0.09, -0.09])
def test_little_is_not_warned_of(change):
    assert warned(blow(change)) == []


@pytest.mark.parametrize(("change", "serious"), [(0.2, False), (0.49, False), (0.51, True), (-0.49, False), (-2, True)])
def test_from_a_twentieth_on_a_warning_is_serious(change, serious):
    (warning,) = warned(blow(change))
    assert warning.serious == serious
    assert ("do not rely on this run" in warning.text) == serious


def test_per_cent():
    assert [per_cent(share) for share in (0, 1e-9, -0.0123, 0.05678, 1, 23.7)] == [
        "0 %", "0 %", "-1.2 %", "5.7 %", "100 %", "2370 %"
    ]  # fmt: skip
