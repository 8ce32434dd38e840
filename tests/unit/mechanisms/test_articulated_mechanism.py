"""Mechanisms that a scene spells out: bodies of any shape, and strokes that move them."""

import tomllib

import numpy as np
import pytest
from articulated_scenes import BALL, OUT, WAG, components, scene
from paths import ROOT, SCENES

from rigidfluid.core.case.load import load_scene, scene_from_dict
from rigidfluid.core.mechanics.rigid import lab_inertia, turned
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import PluginError, SceneError


def momenta(it):
    """Linear and angular, about the centre of mass."""
    mechanisms, free = it.system.motions, it.state.motions
    inertia = lab_inertia(mechanisms.inertia(it.time), free.pose.orientation)[0]
    spin = turned(free.pose.orientation, mechanisms.spin(it.time))[0]
    return np.append(mechanisms.mass[0] * free.twist.velocity[0], inertia @ free.twist.angular_velocity[0] + spin)


def test_without_strokes_it_is_rigid():
    it = Simulation(scene(angular_velocity=3.0))
    assert not it.system.motions.driven
    before = it.state.pose.position[2] - it.state.pose.position[0]
    it.go()
    after = it.state.pose.position[2] - it.state.pose.position[0]
    assert np.linalg.norm(after) == pytest.approx(np.linalg.norm(before), rel=1e-14)
    assert not np.allclose(after, before, rtol=0.1)


def test_components_of_different_shapes_and_densities_carry_the_mass_they_have():
    it = Simulation(scene())
    masses = [np.pi * 0.05**2, 2.0 * np.pi * 0.02, 3.0 * 0.01]
    np.testing.assert_allclose(it.system.mass, masses)
    centre = np.average([0.0, 0.4, 0.8], weights=masses)
    np.testing.assert_allclose(it.state.pose.position[:, 0], 2.0 + np.array([0.0, 0.4, 0.8]) - centre)


def test_a_tail_that_wags_turns_the_whole_and_no_momentum_comes_of_it():
    it = Simulation(scene(WAG, OUT, angular_velocity=1.0, velocity=[0.3, 0.1]))
    before, angles = momenta(it), []
    it.observe(lambda now: angles.append(now.bodies["it"].orientation[0] - now.time))
    it.go()
    np.testing.assert_allclose(momenta(it), before, atol=1e-12)
    assert np.ptp(angles) > 0.01


def test_without_a_fluid_a_step_ends_at_each_corner_and_places_are_exact_there():
    """Corners at times that no step of .007 meets: at 0.03 and 0.05."""
    it, times = Simulation(scene(OUT, end=0.1, step=0.007)), []
    apart = []

    def remember(now):
        times.append(now.time)
        apart.append(now.state.pose.position[1, 0] - now.state.pose.position[0, 0])

    it.observe(remember)
    it.go()
    for corner, distance in ((0.03, 0.46), (0.05, 0.46)):
        nearest = int(np.argmin(np.abs(np.array(times) - corner)))
        assert abs(times[nearest] - corner) <= it.clock.size(it.clock.levels)
        assert apart[nearest] == pytest.approx(distance, abs=0.06 / 0.03 * 0.007 / 1024)


def test_strokes_of_one_component_add_up_and_joints_are_carried_along():
    """A chain bent by a right angle at both joints; then the last link points back."""
    links = [BALL | {"name": name, "position": [x, 0.0]} for name, x in (("a", 0.0), ("b", 1.0), ("c", 2.0))]
    quarter = [[0.0, 0.0], [1.0, 0.5 * np.pi]]
    strokes = [
        {"moves": ["b", "c"], "about": [0.5, 0.0], "piecewise": quarter, "repeat": False},
        {"moves": ["c"], "about": [1.5, 0.0], "piecewise": quarter, "repeat": False},
        {"moves": ["c"], "along": [3.0, 0.0], "piecewise": [[0.0, 0.0], [1.0, 0.25]], "repeat": False},
    ]
    it = Simulation(scene(*strokes, parts=links))
    poses = it.system.motions.poses(it.state.motions.pose, 1.0)
    apart = poses.position - poses.position[0]
    np.testing.assert_allclose(apart[1], [0.5, 0.5], atol=1e-14)
    np.testing.assert_allclose(apart[2], [0.5 - 0.75, 1.0], atol=1e-14)
    np.testing.assert_allclose(poses.orientation[:, 0], [0.0, 0.5 * np.pi, np.pi])


def test_a_stroke_may_come_from_a_file_beside_the_scene(tmp_path):
    (tmp_path / "wag.csv").write_text("0.0, 0.0\n0.1, 0.5\n0.2, 0.0\n", encoding="utf-8")
    stroke = {"moves": ["tail"], "about": [0.6, 0.0], "smooth": {"file": str(tmp_path / "wag.csv")}}
    it = Simulation(scene(stroke))
    assert it.system.motions.poses(it.state.motions.pose, 0.1).orientation[2, 0] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"moves": ["tial"]}, r"mechanism.0.stroke.0.moves: found 'tial'.*components: head, trunk, tail.*'tail'"),
        ({"moves": []}, r"mechanism.0.stroke.0.moves"),
        ({"smooth": []}, r"mechanism.0.stroke.0.smooth: found 0 rows"),
        ({"smooth": [[0, 0], [2, 0], [1, 0]]}, r"mechanism.0.stroke.0.smooth.2: found time 1 after 2"),
        ({"smooth": [[0, 0], [1, 1]]}, r"mechanism.0.stroke.0.smooth.1.*jump back to 0"),
        ({"about": None}, r"mechanism.0.stroke.0: found neither along nor about"),
        ({"along": [1.0, 0.0]}, r"mechanism.0.stroke.0: found both along and about"),
        ({"axis": [0.0, 0.0, 1.0]}, r"mechanism.0.stroke.0.axis.*no axis in 2D"),
        ({"about": [0.0, 0.0, 0.0]}, r"mechanism.0.stroke.0.about.*2 numbers"),
        ({"about": None, "along": [0.0, 0.0]}, r"mechanism.0.stroke.0.along.*length above 0"),
        ({"swings": 1.0}, r"mechanism.0.stroke.0.swings: found a key that nothing reads"),
    ],
)
def test_strokes_that_cannot_be_are_refused(change, message):
    table = {key: value for key, value in (WAG | change).items() if value is not None}
    with pytest.raises(SceneError, match=message):
        scene(table)


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"type": "elipsoid"}, PluginError, r"mechanism.0.component.2.type.*Did you mean 'ellipsoid'"),
        ({"name": "head"}, SceneError, r"mechanism.0.component.2.name.*'head' for the second time"),
        ({"points": [[0.0, 0.0], [1.0, 0.0]]}, SceneError, r"mechanism.0.component.2.points"),
        ({"radius": 1.0}, SceneError, r"mechanism.0.component.2.radius: found a key that nothing reads"),
        ({"position": [1.0]}, SceneError, r"mechanism.0.component.2.position.*2 numbers"),
        ({"density": -1.0}, SceneError, r"mechanism.0.component.2.density.*greater than 0"),
        ({"orientation": [1.0, 0.0, 0.0, 0.0]}, SceneError, r"mechanism.0.component.2.orientation.*in 2D"),
    ],
)
def test_components_that_cannot_be_are_refused(change, error, message):
    with pytest.raises(error, match=message):
        scene(WAG, parts=components(**change))


def test_a_mechanism_without_components_is_refused():
    with pytest.raises(SceneError, match=r"mechanism.0.component.*one component or more"):
        scene(WAG, component=[])


def test_an_overlap_along_the_stroke_is_refused_by_name_and_time():
    stroke = OUT | {"piecewise": [[0.0, 0.0], [0.05, -0.2], [0.1, 0.0]]}
    with pytest.raises(
        SceneError, match=r"mechanism 'it': found components 'head' and 'trunk' that overlap by 0.05 at"
    ):
        scene(stroke)
    with pytest.raises(SceneError, match=r"at time 0.05 of the stroke"):
        scene(stroke)


def test_the_phases_of_the_three_sphere_swimmer_are_four():
    path = SCENES / "swimmer.toml"
    with pytest.raises(SceneError, match=r"mechanism.0.order.*each of left in"):
        load_scene(path, ['mechanism.0.order=["left in", "left in", "left out", "right out"]'])
    with pytest.raises(SceneError, match=r"mechanism.0.amplitude.*less than 8"):
        load_scene(path, ["mechanism.0.amplitude=8.0"])


def test_the_scene_of_the_page_on_mechanisms_swims():
    page = (ROOT / "docs" / "mechanisms.md").read_text(encoding="utf-8")
    tables = tomllib.loads(page.partition("```toml\n")[2].partition("```")[0])
    tables["mesh"] |= {"size": 0.8, "size_body": 0.1}
    tables["time"] |= {"end": 0.1, "step": 0.05}
    it = Simulation(scene_from_dict(tables))
    it.go()
    assert it.bodies["fish"].velocity[0] != 0.0
    assert it.state.ledger.control > 0.0
