"""What a scheme expects of a step in a fluid, from what is known of the one before: equations of motion say it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from linked_bodies import masses, placed, split

from rigidfluid.core.contact.path.body_step import undisturbed
from rigidfluid.core.coupling import fluid_scheme
from rigidfluid.core.coupling.expected_load import expected_load, load_before
from rigidfluid.core.coupling.fluid_scheme import _velocities
from rigidfluid.core.coupling.navier_stokes_scheme import NavierStokesScheme
from rigidfluid.core.coupling.stokes_scheme import StokesScheme
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.single_bodies import SingleBodies
from rigidfluid.core.model.reduced_model import Coupling, Evaluation, ReducedModel
from rigidfluid.core.model.types import Wrench

STEP, VELOCITIES, NONE = 0.1, np.array([0, 1, 4]), np.zeros(0)
"""The model has the velocities of the first of two bodies, and one of the second."""


def model(decay: float = 0.0) -> ReducedModel:
    """Modes at random; friction of twice, three and four times ``decay`` over the mass."""
    modes = np.random.default_rng(3).normal(size=(3, 3))
    return ReducedModel(VELOCITIES, modes, decay * np.array([2.0, 3.0, 4.0]), Evaluation(NONE, NONE), False)


def random(seed: int) -> FloatArray:
    """Rows of two bodies in the plane."""
    return np.random.default_rng(seed).normal(size=(2, 3))


def wrench(rows: FloatArray) -> Wrench:
    return Wrench(rows[:, :2], rows[:, 2:])


def system(**keys: Any) -> Any:
    pose = placed(2, 2)
    rest = split(np.zeros((2, 3)), 2)
    motions = SingleBodies(*masses(2, 2), np.zeros(2, dtype=bool), pose, rest)
    own = {"weight": np.zeros((2, 2)), "inertia": masses(2, 2)[1]}
    return SimpleNamespace(motions=motions, dimension=2, **own | keys)


def state(change: FloatArray, contact: FloatArray, link: FloatArray, applied: tuple[FloatArray, FloatArray]) -> Any:
    """After a step in which twists have changed so, with mean loads of contacts and joints in it; ``applied`` from
    outside in the step and from now on."""
    pose, before = placed(2, 2), random(9)
    past = SimpleNamespace(twist=split(before, 2), step=STEP, applied=wrench(applied[0]))
    now, twist = wrench(applied[1]), split(before + change, 2)
    motions = SimpleNamespace(pose=pose, twist=twist, contact=wrench(contact), hydrodynamic=wrench(random(11)))
    link_load = SimpleNamespace(wrench=link)
    return SimpleNamespace(
        past=past, past_step=STEP, motions=motions, pose=pose, twist=twist, applied=now, link=link_load, coupling=None
    )


def expected(given: Any, known: ReducedModel, size: float) -> FloatArray:
    return expected_load(system(), given, known, load_before(system(), given, known), size)


def test_the_load_that_is_expected_has_moved_the_bodies_in_the_step_before() -> None:
    """M ΔU = (Φ + contacts + joints) Δt; the change of what is applied is added."""
    known, load, contact, link = model(), np.array([1.0, -2.0, 3.0]), random(1), random(2)
    pushed = (contact + link).ravel()[VELOCITIES]
    change = np.zeros((2, 3))
    change.flat[VELOCITIES] = STEP * known.inverse_mass @ (load + pushed)
    given = state(change, contact, link, (random(5), random(6)))
    found = expected(given, known, STEP)
    np.testing.assert_allclose(found, load + (random(6) - random(5)).ravel()[VELOCITIES])


def test_a_load_is_expected_to_grow_on() -> None:
    """By as much in each time as in the step before."""
    known, change, none = model(), np.zeros((2, 3)), (np.zeros((2, 3)), np.zeros((2, 3)))
    given = state(change, np.zeros((2, 3)), np.zeros((2, 3)), none)
    load, growth = np.array([1.0, -2.0, 3.0]), np.array([0.05, 0.15, -4.0])
    given.coupling = Coupling(known, load, load - growth, np.zeros(3))
    np.testing.assert_allclose(expected(given, known, 0.5 * STEP), load + 0.5 * growth)
    np.testing.assert_allclose(expected(given, known, STEP), load + growth)


def test_a_load_that_was_not_known_does_not_grow() -> None:
    known, none = model(), (np.zeros((2, 3)), np.zeros((2, 3)))
    given = state(np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 3)), none)
    given.coupling = Coupling(known, np.ones(3), np.full(3, np.nan), np.zeros(3))
    np.testing.assert_array_equal(expected(given, known, STEP), 0.0)


def shown(
    monkeypatch: pytest.MonkeyPatch,
    used: Coupling,
    found: ReducedModel,
    load: FloatArray,
) -> Coupling:
    """Coupling with the model ``found``, by a first step in which this ``load`` on it, contacts and joints act."""
    contact, link = random(1), random(2)
    monkeypatch.setattr(fluid_scheme, "updated_model", lambda *_: found)
    change, pushed = np.zeros((2, 3)), (contact + link).ravel()[VELOCITIES]
    change.flat[VELOCITIES] = STEP * found.inverse_mass @ (load + pushed)
    before: Any = SimpleNamespace(
        past=None, past_step=None, past_twist=None, motions=undisturbed_motions(np.zeros((2, 3)))
    )
    after: Any = SimpleNamespace(
        past=SimpleNamespace(applied=None),
        past_step=STEP,
        contacts=None,
        motions=undisturbed_motions(change),
        link=SimpleNamespace(wrench=link),
    )
    step: Any = SimpleNamespace(derivative=np.array([1.0, -1.0, 0.0]) / STEP, impulse=STEP * contact)
    path: Any = SimpleNamespace(motions=after.motions)
    return NavierStokesScheme(system())._shown(before, after, path, used, step)


LOAD = np.array([1.0, -2.0, 3.0])


def test_the_load_that_a_solution_shows_has_moved_the_bodies_in_its_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """M ΔU = (Φ + contacts + joints) Δt, in a first step."""
    used = Coupling(model(), np.zeros(3), np.full(3, np.nan), np.zeros(3))
    np.testing.assert_allclose(shown(monkeypatch, used, used.model, LOAD).load, LOAD)


def undisturbed_motions(twist: FloatArray) -> Any:
    """Motions without contacts."""
    return SimpleNamespace(twist=split(twist, 2), contact=wrench(np.zeros((2, 3))))


def test_drag_that_has_slowed_a_body_is_no_load_of_the_next_step() -> None:
    """Φ counts from the velocity at the start of a step, R ΔU less than in the one before."""
    known, change = model(0.7), random(4)
    given = state(change, random(1), random(2), (random(5), random(6)))
    load = np.array([1.0, -2.0, 3.0])
    given.coupling = Coupling(known, load, load, np.zeros(3))
    inverse = np.linalg.inv(known.modes)
    friction = inverse.T @ np.diag(known.decay) @ inverse
    expected = load - friction @ change.ravel()[VELOCITIES] + (random(6) - random(5)).ravel()[VELOCITIES]
    np.testing.assert_allclose(load_before(system(), given, known), expected)
    np.testing.assert_allclose(StokesScheme(system())._expected_loads(given, known, STEP), [expected, expected])


def test_without_inertia_what_was_missed_is_what_the_correction_adds() -> None:
    known, missed, d0 = model(0.7), np.array([0.3, -0.1, 0.2]), 15.0
    step: Any = SimpleNamespace(derivative=np.array([d0, -d0, 0.0]))
    load = StokesScheme(system())._correction(known, step, missed)
    np.testing.assert_allclose(known.response(d0, load) / d0, missed)


def test_friction_of_a_path_without_inertia_is_known_for_certain() -> None:
    path = replace(undisturbed(system(), placed(2, 2), split(random(1), 2), 0.1), friction=0.25)
    found = StokesScheme(system())._with_friction(path)
    assert (found.friction, found.drag_loss) == (0.0, 0.25)


def test_contacts_are_unsteady_where_they_change_velocities_otherwise_than_in_the_step_before() -> None:
    """By more than a tenth of the velocities, or of what contacts give."""
    scheme, known = NavierStokesScheme(system(bounding_radii=np.full(2, 0.2))), model()
    arm, size = np.array([1.0, 1.0, 1.0]), 0.5 * STEP
    coupling = Coupling(known, np.zeros(3), np.zeros(3), np.zeros(3))

    def is_unsteady(speed: float, pushed: float, otherwise: float) -> bool:
        """Whether it is, with these velocities along the first axis, by contacts as in the step before and others."""
        along = np.linalg.solve(known.inverse_mass, arm * np.array([1.0, 0.0, 0.0]))
        given, contact = state(random(4), random(1), random(2), (random(5), random(6))), np.zeros((2, 3))
        given.motions.twist = split(np.array([[speed, 0.0, 0.0], [0.0, 0.0, 0.0]]), 2)
        contact.flat[VELOCITIES] = along
        given.motions.contact = wrench(pushed / size * contact)
        path: Any = SimpleNamespace(
            coupling=coupling, motions=SimpleNamespace(contact=wrench((pushed + otherwise) * contact))
        )
        return scheme.is_unsteady(given, path, size)

    assert [is_unsteady(1.0, 0.0, each) for each in (0.0, 0.09, 0.11)] == [False, False, True]
    assert [is_unsteady(0.0, 1.0, each) for each in (0.0, 0.1, 0.12)] == [False, False, True]
    assert [is_unsteady(0.0, 0.0, each) for each in (0.0, 1e-3)] == [False, True]


def test_contacts_without_dampers_turn_no_ball() -> None:
    """And move what they touch, or what joints link."""
    around: dict[str, Any] = {"bodies": [None, None], "balls": np.array([True, False])}
    near: Any = SimpleNamespace(body_a=np.array([0]), body_b=np.array([1]))

    def found(dissipative: bool, linked: list[bool]) -> list[int]:
        law, joints = SimpleNamespace(dissipative=dissipative), SimpleNamespace(linked=np.array(linked))
        return _velocities(system(law=law, joints=joints, **around), near).tolist()

    assert found(False, [False, False]) == [0, 1, 3, 4, 5]
    assert found(True, [False, False]) == [0, 1, 2, 3, 4, 5]
    near.body_b = np.array([7])
    assert found(False, [False, False]) == [0, 1]
    assert found(False, [True, False]) == [0, 1, 2]
