"""Which bodies' responses are evaluated, by a backend that knows all of them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rigidfluid.core.coupling.impulse_responses import ALONE, share_sides, updated_model
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.mechanics.single_bodies import SingleBodies
from rigidfluid.core.model.reduced_model import ReducedModel
from rigidfluid.core.model.types import Contacts, Pose, Response, Step

WIDTH, D0, RADIUS = 3, 500.0, 0.1
ALONG = np.array([[1.0, 0.0]])


class Bodies:
    """Bodies in the plane whose responses to each other fall with distance, in place of a system, and its backend."""

    def __init__(self, position: FloatArray, period: FloatArray = ALONG[:0]) -> None:
        self.position, count = position, len(position)
        lattice = Lattice(period, np.zeros(2))
        self.domain = SimpleNamespace(cells=lattice)
        apart = np.linalg.norm(lattice.shortened(position[:, None] - position[None, :]), axis=2)
        between = np.where(apart > 0.0, 0.1 * (RADIUS / np.where(apart > 0.0, apart, 1.0)) ** 2, 1.0)
        one = np.array([[2.0, 0.1, 0.0], [0.1, 1.5, 0.05], [0.0, 0.05, 1.0]])
        self.inviscid = np.kron(between, one)
        self.friction = np.diag(np.linspace(50.0, 200.0, count * WIDTH))
        self.viscous = self.viscous_response(D0)
        self.evaluated: list[IntArray] = []
        self.backend = self
        self.bounding_radii = np.full(count, RADIUS)
        self.dimension = 2
        self.motions = SingleBodies(*np.zeros((3, count)), None, None)
        self.twist = np.zeros((count, WIDTH))

    def viscous_response(self, d0: float) -> FloatArray:
        return np.asarray(d0 * np.linalg.inv(d0 * np.linalg.inv(self.inviscid) + self.friction))

    def response(self, fluid: Any, mesh: Any, step: Any, impulses: FloatArray) -> Response:
        flat = impulses.reshape(len(impulses), -1)
        self.evaluated.append(np.unique(np.nonzero(flat)[1] // WIDTH))
        shape = impulses.shape
        return Response((flat @ self.inviscid).reshape(shape), (flat @ self.viscous).reshape(shape))

    def model(self, gaps: FloatArray, known: ReducedModel | None, velocities: IntArray | None = None) -> ReducedModel:
        """The model of bodies with so wide gaps to a wall each."""
        which = np.arange(len(gaps) * WIDTH) if velocities is None else velocities
        return self.touching(at_walls(gaps), which, known)

    def touching(
        self, contacts: Contacts, velocities: IntArray, known: ReducedModel | None, d0: float = D0
    ) -> ReducedModel:
        """The model of bodies with these contacts."""
        count = len(self.position)
        pose = Pose(self.position, np.zeros((count, 1)))
        system: Any = self
        state: Any = SimpleNamespace(fluid=None, mesh=object())
        none = np.zeros((count, WIDTH))
        step = Step(
            time=0.0,
            derivative=np.array([d0, 0.0, 0.0]),
            extrapolation=np.array([1.0, 0.0]),
            pose=pose,
            points=None,
            mass_matrix=np.zeros((count, WIDTH, WIDTH)),
            load=none,
            prescribed=np.zeros(count, dtype=bool),
            prescribed_twist=none,
            impulse=none,
            load_scale=0.0,
            turning=none,
        )
        return updated_model(system, state, step, contacts, self.twist, velocities, known)


def at_walls(gaps: FloatArray) -> Contacts:
    count = len(gaps)
    normal = np.tile([0.0, 1.0], (count, 1))
    none, flat = np.full(count, RADIUS), np.full(count, np.inf)
    point = gaps[:, None] * normal
    a, at_wall = np.arange(count), np.ones(count, dtype=bool)
    return Contacts(a, np.full(count, count), point, 0.0 * point, normal, gaps, none, flat, at_wall)


def film_resistance(gaps: FloatArray) -> FloatArray:
    """Of bodies with one contact each."""
    return 1.0 + 0.1 * RADIUS / gaps


def row(count: int, apart: float) -> FloatArray:
    return np.stack([apart * np.arange(count), np.zeros(count)], axis=1)


GAPS = np.array([0.01, 0.02, 0.03])


@pytest.fixture
def few() -> Bodies:
    return Bodies(row(3, 0.3))


def test_the_responses_are_the_backend_s(few):
    model = few.model(GAPS, None)
    np.testing.assert_allclose(model.inverse_mass, few.inviscid, atol=1e-12)
    np.testing.assert_allclose(model.response(D0, np.eye(9)), few.viscous, atol=1e-12)
    assert not model.shared
    np.testing.assert_allclose(model.evaluation.film_resistance, np.repeat(film_resistance(GAPS), WIDTH))


def test_nothing_is_evaluated_where_little_has_changed(few):
    first = few.model(GAPS, None)
    assert few.model(GAPS * [1.015, 0.985, 1.0], first) is first
    assert len(few.evaluated) == 1


def test_small_changes_add_up(few):
    model, evaluations = few.model(GAPS, None), []
    for factor in (1.01, 1.025, 1.035):
        model = few.model(GAPS * [factor, 1.0, 1.0], model)
        evaluations.append(len(few.evaluated))
    assert evaluations == [1, 2, 2]


def test_small_changes_add_up_while_others_are_evaluated(few):
    first = few.model(GAPS, None)
    second = few.model(GAPS * [1.01, 1.5, 1.0], first)
    few.model(GAPS * [1.025, 1.5, 1.0], second)
    assert [bodies.tolist() for bodies in few.evaluated] == [[0, 1, 2], [1], [0]]


def test_only_those_in_changed_places_are_evaluated_again(few):
    first = few.model(GAPS, None)
    few.inviscid, few.viscous = 1.2 * few.inviscid, 1.1 * few.viscous
    later = few.model(GAPS * [1.0, 1.1, 1.0], first)
    np.testing.assert_array_equal(few.evaluated[1], [1])
    changed = np.zeros((9, 9), dtype=bool)
    changed[3:6], changed[:, 3:6] = True, True
    np.testing.assert_allclose(later.inverse_mass, np.where(changed, few.inviscid, few.inviscid / 1.2), atol=1e-12)
    expected = np.repeat(film_resistance(GAPS * [1.0, 1.1, 1.0]), WIDTH)
    np.testing.assert_allclose(later.evaluation.film_resistance, expected)


def test_bodies_that_move_otherwise_are_evaluated_again(few):
    first = few.model(GAPS, None)
    few.twist = np.zeros((3, WIDTH))
    few.twist[1, 0], few.twist[2, 2] = 0.005 * RADIUS * D0, 0.02 * D0
    few.model(GAPS, first)
    assert [bodies.tolist() for bodies in few.evaluated] == [[0, 1, 2], [2]]


def test_a_contact_of_two_bodies_resists_both(few):
    first = few.model(GAPS, None)
    pair = at_walls(GAPS)
    pair.body_b[0] = 1
    later = few.touching(pair, first.velocities, first)
    np.testing.assert_array_equal(few.evaluated[1], [1])
    assert later.evaluation.film_resistance[3] == pytest.approx(1.0 + 0.1 * RADIUS * (1.0 / 0.01 + 1.0 / 0.02))


def test_fewer_velocities_need_no_evaluation(few):
    first, some = few.model(GAPS, None), np.array([0, 1, 6, 7, 8])
    fewer = few.model(GAPS, first, some)
    assert len(few.evaluated) == 1
    np.testing.assert_array_equal(fewer.velocities, some)
    np.testing.assert_allclose(fewer.inverse_mass, few.inviscid[np.ix_(some, some)], atol=1e-12)
    np.testing.assert_allclose(fewer.response(D0, np.eye(5)), few.viscous[np.ix_(some, some)], atol=1e-12)


def test_another_body_is_evaluated_alone(few):
    first = few.model(GAPS, None, np.arange(6))
    more = few.model(GAPS, first)
    assert [bodies.tolist() for bodies in few.evaluated] == [[0, 1], [2]]
    np.testing.assert_allclose(more.inverse_mass, few.inviscid, atol=1e-12)


def test_without_velocities_nothing_is_evaluated(few):
    assert len(few.model(GAPS, None, np.arange(0)).velocities) == 0
    assert few.evaluated == []


def test_a_step_of_another_length_remembers_mass_and_friction(few):
    first = few.model(GAPS, None)
    few.viscous = few.viscous_response(2.0 * D0)
    later = few.touching(at_walls(GAPS * [1.0, 1.1, 1.0]), first.velocities, first, 2.0 * D0)
    np.testing.assert_array_equal(few.evaluated[1], [1])
    np.testing.assert_allclose(later.response(2.0 * D0, np.eye(9)), few.viscous, atol=1e-12)


def test_many_share_right_sides():
    """The nearest of those pushed is the one that a body is taken to respond to; the rest is small."""
    count = 4 * ALONE
    many, sides = Bodies(row(count, 0.25)), []
    response = many.response

    def counted(fluid: Any, mesh: Any, step: Any, impulses: FloatArray) -> Response:
        sides.append(len(impulses))
        assert step.shared
        return response(fluid, mesh, step, impulses)

    many.response = counted  # type: ignore[method-assign]
    model = many.model(np.full(count, 0.01), None)
    assert model.shared
    assert sides[0] < 0.2 * count * WIDTH
    size = np.linalg.norm(many.inviscid, ord=2)
    assert np.linalg.norm(model.inverse_mass - many.inviscid, ord=2) < 0.02 * size
    assert np.linalg.norm(model.response(D0, np.eye(count * WIDTH)) - many.viscous, ord=2) < 0.02 * size
    own = np.arange(count * WIDTH).reshape(count, WIDTH)
    for body in own:
        block = np.ix_(body, body)
        np.testing.assert_allclose(model.inverse_mass[block], many.inviscid[block], atol=0.02)


def test_few_of_many_that_changed_share_right_sides_too():
    """Those far apart, of a model of many, however few are evaluated."""
    count = 4 * ALONE
    many = Bodies(row(count, 0.25))
    gaps = np.full(count, 0.01)
    first = many.model(gaps, None)
    sides, response = [], many.response

    def counted(fluid: Any, mesh: Any, step: Any, impulses: FloatArray) -> Response:
        sides.append(len(impulses))
        return response(fluid, mesh, step, impulses)

    many.response = counted  # type: ignore[method-assign]
    gaps[:: 4 * 3] *= 1.5
    many.model(gaps, first)
    np.testing.assert_array_equal(many.evaluated[1], np.arange(count)[:: 4 * 3])
    assert sides == [WIDTH]


def test_bodies_near_each_other_across_periodic_surfaces_share_no_right_side():
    """A row along the whole period, first and last one of which are neighbours, responds as one inside it would."""
    count, apart = 4 * ALONE, 0.25
    ring = Bodies(row(count, apart), count * apart * ALONG)
    model = ring.model(np.full(count, 0.01), None)
    first, last = np.arange(WIDTH), np.arange(WIDTH) + (count - 1) * WIDTH
    for one, other in ((first, first), (last, last), (first, last)):
        block = np.ix_(one, other)
        np.testing.assert_allclose(model.inverse_mass[block], ring.inviscid[block], atol=0.02)
    assert np.abs(ring.inviscid[np.ix_(first, last)]).max() > 0.02


@pytest.mark.parametrize(("bodies", "share"), [(ALONE, False), (ALONE + 1, True)])
def test_many_bodies_share_whatever_their_components(bodies, share):
    two_of_three = (np.arange(bodies)[:, None] * WIDTH + np.arange(2)).ravel()
    assert share_sides(two_of_three, WIDTH) is share


def test_a_model_that_is_shared_no_longer_is_evaluated_anew_for_all_that_stay():
    """Three digits do for many; few have all, also those whose gaps and motion stay the same."""
    bodies = Bodies(row(ALONE + 1, 0.3))
    gaps = np.full(ALONE + 1, 0.01)
    shared = bodies.model(gaps, None)
    few = bodies.model(gaps, shared, np.arange(ALONE * WIDTH))
    assert shared.shared
    assert not few.shared
    np.testing.assert_array_equal(bodies.evaluated[-1], np.arange(ALONE))
    stay = slice(ALONE * WIDTH)
    np.testing.assert_allclose(few.inverse_mass, bodies.inviscid[stay, stay], rtol=0, atol=1e-12)
