"""Films between ellipsoids: the radius of the ball at a flat wall that squeezes as thin a film alike."""

from typing import Any

import numpy as np
import pytest
from scenes import dry_tables

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.pairs.proximity import detect
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Pose
from rigidfluid.errors import SceneError

FILM = {"law": "lubrication", "range": 1.0, "viscosity": 0.7, "cutoff": 1e-6}


def system_tables(*bodies: dict[str, Any]) -> dict[str, Any]:
    """Of bodies in a dry box of side 10 about the origin."""
    dimension = len(bodies[0]["position"])
    return dry_tables(
        *[{"name": f"body_{number}", "density": 1.0} | table for number, table in enumerate(bodies)],
        domain={"lower": [-5.0] * dimension, "upper": [5.0] * dimension},
        contact=FILM,
        output={"every": 0.01},
    )


def system(*bodies: dict[str, Any]) -> System:
    return build_system(scene_from_dict(system_tables(*bodies)))


def ellipsoid(semi_axes: list[float], position: list[float]) -> dict[str, Any]:
    return {"type": "ellipsoid", "semi_axes": semi_axes, "position": position}


def contacts(made: System, orientation: FloatArray | None = None) -> Contacts:
    pose = made.pose if orientation is None else Pose(made.pose.position, orientation)
    return detect(made, pose, None, 1.0)


def squeezed(height: FloatArray, spacing: float) -> float:
    """∫ p dA with ∇·(h³∇p) = -12 for heights h (N, N) on a grid, p = 0 around it."""
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import spsolve

    number = np.arange(height.size).reshape(height.shape)
    rows, columns, values = [], [], []
    for one, other in ((number[1:], number[:-1]), (number[:, 1:], number[:, :-1])):
        a, b = one.ravel(), other.ravel()
        flux = (0.5 * (height.ravel()[a] + height.ravel()[b])) ** 3
        rows += [a, b, a, b]
        columns += [a, b, b, a]
        values += [flux, flux, -flux, -flux]
    matrix = coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsr()
    inside = number[1:-1, 1:-1].ravel()
    pressure = spsolve(matrix[inside][:, inside], np.full(len(inside), 12.0 * spacing**2))
    return float(pressure.sum()) * spacing**2


def test_two_tilted_ellipsoids_resist_as_reynolds_equation_says() -> None:
    """Nothing of the closed form is used: their heights over the plane between them, and finite differences."""
    made = system(ellipsoid([1.5, 0.8, 1.0], [0.0, 0.0, 1.0015]), ellipsoid([1.6, 0.7, 1.0], [0.0, 0.0, -1.0015]))
    angle = 0.5 * np.array([0.0, 0.6])  # of quaternions about z, so that the vertices stay nearest
    orientation = np.column_stack([np.cos(angle), 0.0 * angle, 0.0 * angle, np.sin(angle)])
    found = contacts(made, orientation)
    x, y = np.meshgrid(*[np.linspace(-0.6, 0.6, 241)] * 2, indexing="ij")
    gap = float(found.gap[0])
    height = np.full_like(x, gap)
    for axes, turn in (((1.5, 0.8), 0.0), ((1.6, 0.7), 0.6)):
        along, across = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
        height += 0.5 * ((along / axes[0]) ** 2 + (across / axes[1]) ** 2)
    exact = squeezed(height, float(x[1, 0] - x[0, 0]))
    assert gap == pytest.approx(0.003)
    assert 6.0 * np.pi * found.effective_radius[0] ** 2 / gap == pytest.approx(exact, rel=0.03)


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.2])
def test_an_ellipse_at_a_wall_has_its_radius_of_curvature_there(angle: float) -> None:
    """r = a²b²/h³ where its tangent is h away from the centre."""
    made = system({"type": "ellipsoid", "semi_axes": [1.5, 0.6], "position": [0.0, -3.6]})
    found = contacts(made, np.array([[angle]]))
    height = np.hypot(1.5 * np.sin(angle), 0.6 * np.cos(angle))
    assert found.gap[0] == pytest.approx(5.0 - 3.6 - height)
    assert found.effective_radius[0] == pytest.approx((1.5 * 0.6) ** 2 / height**3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_balls_and_ellipsoids_with_equal_axes_are_alike(dimension: int) -> None:
    """Just off a ball the tensors are used, on it the radii; and both in one contact."""
    far, height = [0.0] * (dimension - 1), [1.7]
    for radii in ((0.9, 0.4), (0.4, 0.9)):
        placed = [{"position": far + position} for position in (height, [0.0])]
        balls = [table | {"type": "sphere", "radius": r} for table, r in zip(placed, radii, strict=True)]
        axes = [[r * (1.0 + 1e-9), *[r] * (dimension - 1)] for r in radii]
        nearly = [table | {"type": "ellipsoid", "semi_axes": a} for table, a in zip(placed, axes, strict=True)]
        expected = contacts(system(*balls)).effective_radius
        np.testing.assert_array_equal(expected, [1.0 / (1.0 / radii[0] + 1.0 / radii[1])])
        for pair in (nearly, [nearly[0], balls[1]], [balls[0], nearly[1]]):
            np.testing.assert_allclose(contacts(system(*pair)).effective_radius, expected, rtol=1e-7)


def test_ellipses_slow_down_in_a_run_as_their_film_says() -> None:
    """m dV/dt = -c(h) V has V = V₀ - ∫ c dh/m at any gap h, with R = b²/2a of two ellipses point to point."""
    long, short, begin, cutoff, viscosity, speed = 0.2, 0.1, 0.05, 0.008, 0.08, 2.0
    scene = system_tables(
        *(
            {"type": "ellipsoid", "semi_axes": [long, short], "position": [x, 0.0], "velocity": [-v, 0.0]}
            for x, v in ((0.25, 0.5 * speed), (-0.25, -0.5 * speed))
        )
    ) | {
        "contact": FILM | {"range": begin, "viscosity": viscosity, "cutoff": cutoff},
        "time": {"end": 0.047, "step": 1e-3},
    }
    bodies = rigidfluid.run(scene_from_dict(scene)).bodies
    found, gap = -2.0 * bodies["vx"][::2], bodies["gap"][::2]
    radius, mass, h = short**2 / (2.0 * long), np.pi * long * short / 2.0, np.minimum(gap, begin)
    film = 2.0 * radius**1.5 * (h**-0.5 - begin**-0.5) - (radius / begin) ** 1.5 * (begin - h)
    expected = speed - 3.0 * np.sqrt(2.0) * np.pi * viscosity / mass * film
    assert gap.min() > cutoff
    assert found[-1] < 0.7 * speed
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-3 * speed)


@pytest.mark.parametrize("dimension", [2, 3])
def test_curvature_tensors_are_the_second_derivatives_of_the_distances(dimension: int) -> None:
    axes, radius, room = [0.9, 0.5, 0.7][:dimension], 0.6, [0.0] * (dimension - 2)
    bodies = ellipsoid(axes, [0.2, 1.4, *room]), ellipsoid(axes[::-1], [0.0, -0.1, *room])
    ball = {"type": "sphere", "radius": radius, "position": [-1.5, -0.9, *room]}
    tables = system_tables(*bodies, ball) | {"contact": FILM | {"sliding": True, "range": 20.0}}
    made = build_system(scene_from_dict(tables))
    turns = np.random.default_rng(2).normal(size=made.pose.orientation.shape)
    turns /= 1.0 if dimension == 2 else np.linalg.norm(turns, axis=1, keepdims=True)
    pose = Pose(made.pose.position, turns)
    found, step = detect(made, pose, None, 20.0), 1e-4
    assert set(found.body_b) > {1, 2, 3}
    assert np.count_nonzero(~found.at_wall) == 3
    assert found.curvatures is not None
    rotation = rotation_matrices(pose.orientation)
    for row in range(len(found)):
        for side, (body, point) in enumerate(
            [(found.body_a[row], found.point_a[row]), (found.body_b[row], found.point_b[row])]
        ):
            wall = {each.surface: each.shape for each in made.walls}.get(int(body))
            turn = np.eye(dimension) if wall else rotation[body]
            own = point if wall else (point - pose.position[body]) @ turn
            normals = (wall or made.bodies[body]).normal
            aside = step * np.eye(dimension)
            tensor = turn @ (normals(own + aside) - normals(own - aside)) @ turn.T / (2.0 * step)
            np.testing.assert_allclose(found.curvatures[row, side], tensor, rtol=0, atol=1e-5)


def test_tensors_are_found_only_where_a_law_asks_and_a_body_is_no_ball() -> None:
    one, ball = ellipsoid([0.9, 0.5], [0.0, 0.0]), {"type": "sphere", "radius": 0.4, "position": [0.0, 1.0]}
    for bodies, sliding, expected in (((one, ball), True, True), ((one, ball), False, False), ((ball,), True, False)):
        made = build_system(scene_from_dict(system_tables(*bodies) | {"contact": FILM | {"sliding": sliding}}))
        assert (detect(made, made.pose, None, 10.0).curvatures is not None) == expected


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
def test_ellipsoids_that_slide_past_each_other_keep_momentum_and_the_account(stepping: str) -> None:
    """Linear and angular momentum, by the film's forces and couples alone; what it takes is the kinetic energy lost."""
    moving = {"velocity": [1.0, 0.4, -0.2], "angular_velocity": [0.5, -0.8, 0.6]}
    first = ellipsoid([0.9, 0.5, 0.7], [0.1, 0.0, 1.26]) | moving
    second = ellipsoid([0.7, 0.8, 0.5], [0.0, 0.0, 0.0])
    film = FILM | {"sliding": True, "range": 0.2, "cutoff": 0.02, "viscosity": 0.1, "stepping": stepping}
    scene = system_tables(first, second) | {"contact": film, "time": {"end": 0.03, "step": 3e-3}}
    made, history = build_system(scene_from_dict(scene)), rigidfluid.run(scene_from_dict(scene))
    shape = len(history.bodies["x"]) // 2, 2
    place, velocity, turn, spin = (
        np.stack([history.bodies[name].reshape(shape) for name in names], axis=2)
        for names in (("x", "y", "z"), ("vx", "vy", "vz"), ("qw", "qx", "qy", "qz"), ("wx", "wy", "wz"))
    )
    frame = rotation_matrices(turn.reshape(-1, 4)).reshape(*shape, 3, 3)
    own = np.einsum("tbij,bjk,tblk,tbl->tbi", frame, made.inertia, frame, spin)
    pushed = made.mass[:, None] * velocity
    for total in (pushed.sum(axis=1), (np.cross(place, pushed) + own).sum(axis=1)):
        np.testing.assert_allclose(total, np.broadcast_to(total[:1], total.shape), rtol=0, atol=1e-6)
    assert np.abs(own[-1, 1]).max() > 1e-3
    assert history.energy["contact_loss"][-1] > 1e-3 * history.energy["kinetic"][0]
    assert abs(history.summary["energy"]["relative_residual"]) < 1e-4


def test_bodies_of_facets_are_refused() -> None:
    corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    with pytest.raises(SceneError, match="'lubrication' with bodies of unknown curvature"):
        system({"type": "polygon", "points": corners, "position": [0.0, 0.0]})
