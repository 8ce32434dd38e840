"""Models made in Python: what they run like, and what they refuse."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import pytest

from rigidfluid.api import (
    Box,
    BoxOptions,
    Component,
    ContactLaw,
    Fluid,
    ForceLaw,
    Material,
    Mechanism,
    MeshTable,
    Model,
    Newtonian,
    OutputTable,
    PartOptions,
    PlacedMechanism,
    Pose,
    RigidBody,
    SceneError,
    Selected,
    Simulation,
    Sphere,
    SphereOptions,
    TimeTable,
    build_system,
    model_of,
    run,
    scene_from_dict,
)
from rigidfluid.checks import check

TABLES: dict[str, Any] = {
    "scene": {"name": "fall", "dimension": 2},
    "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.5]},
    "body": [{"name": "disk", "type": "sphere", "radius": 0.15, "density": 2.0, "position": [0.4, 0.25]}],
    "fluid": {"density": 1.0, "viscosity": 0.02, "gravity": [0.0, -1.0]},
    "contact": {"law": "linear", "range": 0.05},
    "mesh": {"size": 0.25, "size_body": 0.06},
    "time": {"end": 0.06, "step": 0.02},
    "output": {"every": 0.06},
}


class Linear(ForceLaw):
    """A spring that is there below the range."""

    name: ClassVar[str] = "linear"

    def force(self, contacts):  # type: ignore[no-untyped-def]
        return 5.0 * np.maximum(self.range - contacts.gap, 0.0)[:, None] * contacts.normal

    def energy(self, contacts):  # type: ignore[no-untyped-def]
        return 2.5 * np.maximum(self.range - contacts.gap, 0.0) ** 2

    def stiffness(self, contacts):  # type: ignore[no-untyped-def]
        return np.where(contacts.gap < self.range, 5.0, 0.0)


class Nut(Sphere):
    """A shape of a name that no scene can give."""

    name: ClassVar[str] = "nut"


class Pair(Mechanism):
    """Two nuts side by side."""

    name: ClassVar[str] = "pair"

    @property
    def components(self) -> list[Component]:
        return [Component(side, Nut(SphereOptions(radius=0.1), 2), 2.0) for side in ("left", "right")]

    def placement(self, time: float) -> Pose:
        return Pose(np.array([[-0.15, 0.0], [0.15, 0.0]]), np.zeros((2, 1)))


class Thinning(Material):
    """Shear-thinning, which no backend here solves for."""

    name: ClassVar[str] = "thinning"
    dynamic_viscosity = 0.02

    def viscosity(self, shear_rate):  # type: ignore[no-untyped-def]
        return self.dynamic_viscosity / (1.0 + shear_rate)


def fall(**changes: Any) -> Model:
    """The scene of the tables, made in Python, with a law that is registered nowhere."""
    given: dict[str, Any] = {
        "domain": Box(BoxOptions(lower=(0.0, 0.0), upper=(1.0, 1.5)), 2),
        "bodies": [RigidBody("disk", Sphere(SphereOptions(radius=0.15), 2), density=2.0, position=(0.4, 0.25))],
        "time": TimeTable(end=0.06, step=0.02),
        "output": OutputTable(every=0.06),
        "fluid": Fluid(1.0, Newtonian(0.02), MeshTable(size=0.25, size_body=0.06)),
        "gravity": (0.0, -1.0),
        "laws": [ContactLaw(Selected(Linear, PartOptions()), range=0.05)],
    }
    return Model(**given | changes)


def model_fluid() -> Fluid:
    fluid = model_of(scene_from_dict(TABLES | {"contact": {}})).fluid
    assert isinstance(fluid, Fluid)
    return fluid


def test_a_model_of_objects_runs_like_the_scene_to_the_last_bit(install: Any) -> None:
    """Registered, the law is the scene's; the disk starts at a gap of .1 and comes within its range."""
    code = """
        import numpy as np
        from rigidfluid.api import ForceLaw, hookimpl

        class Linear(ForceLaw):
            name = "linear"
            def force(self, contacts):
                return 5.0 * np.maximum(self.range - contacts.gap, 0.0)[:, None] * contacts.normal
            def energy(self, contacts):
                return 2.5 * np.maximum(self.range - contacts.gap, 0.0) ** 2
            def stiffness(self, contacts):
                return np.where(contacts.gap < self.range, 5.0, 0.0)

        @hookimpl
        def rigidfluid_force_laws():
            return [Linear]
    """
    made = run(fall(bodies=[replace(fall().bodies[0], velocity=(0.0, -1.5))]))
    install(code, name="linear", module="linear")
    tables = TABLES | {"body": [TABLES["body"][0] | {"velocity": [0.0, -1.5]}]}
    read = run(scene_from_dict(tables))
    assert made.bodies["cfy"].max() > 0.0
    for name in ("x", "y", "vy", "angle", "cfy", "fy"):
        np.testing.assert_array_equal(made.bodies[name], read.bodies[name])


def test_a_scene_and_its_model_are_taken_alike() -> None:
    scene = scene_from_dict(TABLES | {"contact": {}})
    read, made = check(scene), check(model_of(scene))
    assert (read.domain, read.features, read.bodies) == (made.domain, made.features, made.bodies)
    assert build_system(scene).surfaces == build_system(model_of(scene)).surfaces == Simulation(scene).system.surfaces
    assert model_of(model_of(scene)) is model_of(scene)


def test_components_have_shapes_that_no_scene_can_name() -> None:
    placed = PlacedMechanism("pair", Pair(PartOptions(), 2), position=(0.5, 0.7))
    history = run(fall(bodies=[], mechanisms=[placed]))
    assert history.bodies["y"][-1] < 0.7
    assert [body.name for body in fall(bodies=[], mechanisms=[placed]).all_bodies] == ["pair.left", "pair.right"]


DISK = fall().bodies[0]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bodies": []}, "body: found nothing"),
        ({"bodies": [replace(DISK, density=-1.0)]}, "body.0.density: found -1.0"),
        ({"bodies": [replace(DISK, position=(0.4, 0.25, 0.0))]}, "body.0.position: .* 2 finite numbers"),
        ({"bodies": [replace(DISK, velocity=(np.nan, 0.0))]}, "body.0.velocity: .* 2 finite numbers"),
        ({"bodies": [DISK, DISK]}, "body.1.name: found 'disk'"),
        ({"bodies": [replace(DISK, fixed=True, velocity=(1.0, 0.0))]}, "body.0.fixed"),
        ({"boundary": {"roof": None}}, "boundary 'roof': .* allowed is left, right, bottom, top"),
        ({"laws": [ContactLaw(Selected(Linear, PartOptions()), 0.05, names=("disc",))]}, "contact.names.0: .*'disc'"),
        ({"fluid": replace(model_fluid(), density=0.0)}, "fluid.density: found 0.0"),
        ({"fluid": replace(model_fluid(), source=lambda time, points: np.zeros(3))}, "fluid.force: .* shape"),
        ({"fluid": replace(model_fluid(), material=Thinning())}, "fluid.material: found Thinning .* Newtonian"),
        ({"time": TimeTable(end=0.01, step=0.02)}, "time.step"),
    ],
)
def test_a_model_that_contradicts_itself_is_refused_where_it_is_made(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        fall(**changes)


def test_a_table_made_in_python_is_refused_as_one_that_is_read() -> None:
    with pytest.raises(SceneError, match=r"TimeTable.step: found nothing"):
        TimeTable(end=1.0)  # type: ignore[call-arg]
    with pytest.raises(SceneError, match=r"MeshTable.size: found -1.0"):
        MeshTable(size=-1.0, size_body=0.1)
