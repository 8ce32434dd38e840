"""Models made in Python: what they run like, and what they refuse."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from rigidfluid.api import (
    Box,
    BoxOptions,
    Component,
    ContactLaw,
    ContactStepping,
    Fluid,
    ForceLaw,
    Material,
    Mechanism,
    MeshTable,
    Model,
    Newtonian,
    NoFluid,
    NormalLaw,
    NormalOptions,
    NoSlip,
    OutputError,
    OutputTable,
    PartOptions,
    Periodic,
    PlacedMechanism,
    Pose,
    RigidBody,
    RigidfluidError,
    SceneError,
    Selected,
    Simulation,
    Slip,
    Sphere,
    SphereOptions,
    TimeTable,
    build_system,
    model_of,
    run,
    scene_from_dict,
)
from rigidfluid.checks import check
from rigidfluid.core.scene.mesh_tables import SizeFieldTable
from rigidfluid.post.reports.results import read_results

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


def test_a_law_names_a_face_by_either_name() -> None:
    law = ContactLaw(Selected(Linear, PartOptions()), range=0.05, names=("ymin",))
    by_other, by_name = (build_system(fall(laws=[replace(law, names=(name,))])) for name in ("ymin", "bottom"))
    assert [one.surfaces for one in by_other.interactions] == [one.surfaces for one in by_name.interactions]


def test_components_have_shapes_that_no_scene_can_name() -> None:
    placed = PlacedMechanism("pair", Pair(PartOptions(), 2), position=(0.5, 0.7))
    history = run(fall(bodies=[], mechanisms=[placed]))
    assert history.bodies["y"][-1] < 0.7
    assert [body.name for body in fall(bodies=[], mechanisms=[placed]).all_bodies] == ["pair.left", "pair.right"]


DISK = fall().bodies[0]
BOX = fall().domain
FIELD = MeshTable(size=0.25, size_body=0.06, field=(SizeFieldTable(type="vorticity"),))


def law(**values: Any) -> ContactLaw:
    return ContactLaw(Selected(Linear, PartOptions()), **{"range": 0.05, **values})


def fluid(**changes: Any) -> Fluid:
    return replace(model_fluid(), **changes)


class Belt(NoSlip):
    """A wall that bodies would meet at rest and the fluid in motion."""

    def velocity(self, time: float, points: Any) -> Any:
        return np.tile([0.1, 0.0], (len(points), 1))


class Dipped(Nut):
    """A shape whose inertia is negative."""

    @property
    def unit_inertia(self) -> Any:
        return -np.eye(1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda: {"bodies": [], "fluid": NoFluid()}, "body: found nothing"),
        (lambda: {"bodies": [replace(DISK, density=-1.0)]}, "RigidBody.density: found -1.0"),
        (lambda: {"bodies": [replace(DISK, density=True)]}, "RigidBody.density: found True"),
        (lambda: {"bodies": [replace(DISK, fixed="no")]}, "RigidBody.fixed: found 'no'"),
        (lambda: {"bodies": [replace(DISK, free="xy")]}, "RigidBody.free: found 'xy'"),
        (lambda: {"bodies": [replace(DISK, shape=None)]}, "RigidBody.shape: found None"),
        (lambda: {"bodies": [replace(DISK, position=None)]}, "RigidBody.position: found None"),
        (lambda: {"bodies": [replace(DISK, position=(0.4, 0.25, 0.0))]}, "body.0.position: .* 2 numbers"),
        (lambda: {"bodies": [replace(DISK, velocity=(np.nan, 0.0))]}, "RigidBody.velocity: .* finite numbers"),
        (lambda: {"bodies": [replace(DISK, shape=Sphere(SphereOptions(radius=0.1), 3))]}, "body.0: found Sphere in 3D"),
        (
            lambda: {"bodies": [replace(DISK, shape=Dipped(SphereOptions(radius=0.1), 2))]},
            r"body 'nut', unit_inertia: found \[\[-1.0\]\]; allowed is a symmetric matrix of positive moments",
        ),
        (lambda: {"bodies": [DISK, DISK]}, "body.1.name: found 'disk'"),
        (lambda: {"bodies": [replace(DISK, fixed=True, velocity=(1.0, 0.0))]}, "body.0.fixed"),
        (lambda: {"domain": None}, "Model.domain: found None"),
        (lambda: {"name": "a/b"}, "Model.name: found 'a/b'"),
        (lambda: {"gravity": (0.0, 0.0, -1.0)}, "fluid.gravity: .* 2 numbers"),
        (lambda: {"boundary": {"roof": NoSlip}}, "boundary 'roof': .* allowed is left, right, bottom, top"),
        (lambda: {"boundary": {"top": None}}, "Model.boundary.top: found None"),
        (lambda: {"boundary": {"top": Belt}}, "boundary: found a wall 'top' with a velocity of its own at time 0"),
        (lambda: {"boundary": {"left": Periodic, "right": Periodic}}, "'periodic' on 'left', which is not in a pair"),
        (lambda: {"domain": BOX.with_periodic(((0, 1),))}, "'wall' on 'left', which is in a pair"),
        (lambda: {"domain": BOX.with_periodic(((0, 7),))}, r"domain.periodic: found the pair \(0, 7\)"),
        (lambda: {"domain": BOX.with_periodic(((0, 3),))}, "domain.periodic: .* face each other"),
        (lambda: {"laws": [law(names=("disc",))]}, "contact.names.0: .*'disc'"),
        (lambda: {"laws": [law(), law(names=("disc",))]}, r"interaction\.1\.names\.0: .*'disc'"),
        (lambda: {"laws": [law(smallest_gap=0.1), law()]}, r"interaction\.0\.smallest_gap: .* interaction\.0\.range"),
        (lambda: {"laws": [law(), law(smallest_gap=0.1, field="felt")]}, r"felt\.smallest_gap: .* felt\.range"),
        (lambda: {"laws": [law(names="disk")]}, "ContactLaw.names: found 'disk'"),
        (lambda: {"laws": [law(range=0.0)]}, "ContactLaw.range: found 0.0"),
        (lambda: {"laws": [law(restitution=0.0)]}, "ContactLaw.restitution: found 0.0"),
        (lambda: {"laws": [law(restitution=2.0)]}, "ContactLaw.restitution: found 2.0"),
        (lambda: {"laws": [law(smallest_gap=0.0)]}, "ContactLaw.smallest_gap: found 0.0"),
        (lambda: {"laws": [law(between="bodies")]}, "ContactLaw.between: found 'bodies'"),
        (lambda: {"stepping": ContactStepping(substeps=-1)}, "ContactStepping.substeps: found -1"),
        (lambda: {"stepping": ContactStepping(substeps=3, implicit=True)}, "contact.substeps: found 3"),
        (lambda: {"fluid": fluid(density=0.0)}, "Fluid.density: found 0.0"),
        (lambda: {"fluid": fluid(inertia="stokes")}, "Fluid.inertia: found 'stokes'"),
        (lambda: {"fluid": fluid(initial="stedy")}, "Fluid.initial.*: found 'stedy'"),
        (
            lambda: {"fluid": fluid(initial=lambda time, points: np.full_like(points, np.nan))},
            "fluid.initial: .* finite",
        ),
        (lambda: {"fluid": fluid(source=lambda time, points: np.zeros(3))}, "fluid.force: .* shape"),
        (lambda: {"fluid": fluid(material=Thinning())}, "fluid.material: found Thinning .* Newtonian"),
        (lambda: {"fluid": fluid(backend=NoFluid().backend)}, "fluid.backend: found 'dry'"),
        (lambda: {"fluid": NoFluid(backend=model_fluid().backend)}, "fluid.backend: found 'scikit-fem'"),
        (
            lambda: {
                "fluid": fluid(mesh=MeshTable(size=0.25, size_body=0.06, field=(SizeFieldTable(type="vorticity"),)))
            },
            "mesh.field: found 1 tables",
        ),
        (lambda: {"time": TimeTable(end=0.01, step=0.02)}, "time.step"),
    ],
)
def test_a_model_that_contradicts_itself_is_refused_where_it_is_made(change: Any, message: str) -> None:
    with pytest.raises(RigidfluidError, match=message):
        fall(**change())


def test_an_option_that_a_law_refuses_of_its_loads_names_which_of_several_it_is() -> None:
    strong = Selected(NormalLaw, NormalOptions(epsilon="auto"))
    resting = fall(fluid=NoFluid(2.0), laws=[law(), ContactLaw(strong, range=0.05)])
    with pytest.raises(SceneError, match=r"^interaction\.1\.epsilon: "):
        build_system(resting)


def test_numbers_of_numpy_and_lists_are_taken() -> None:
    plain = fall(bodies=[replace(DISK, density=np.float32(2.0), position=[0.4, 0.25], velocity=np.zeros(2))])
    np.testing.assert_array_equal(plain.bodies[0].position, DISK.position)
    assert type(plain.bodies[0].density) is float


def test_a_model_does_not_change_with_the_values_it_was_made_of() -> None:
    position, boundary = np.array([0.4, 0.25]), {"top": Slip}
    model = fall(bodies=[replace(DISK, position=position)], boundary=boundary)
    position[0], boundary["top"] = 0.6, NoSlip
    assert model.bodies[0].position == (0.4, 0.25)
    assert isinstance(model.conditions[3], Slip)


@pytest.mark.parametrize(
    "change",
    [
        {"gravity": (0.0, -50.0)},
        {"bodies": [replace(DISK, shape=Sphere(SphereOptions(radius=0.14), 2))]},
        {"bodies": [replace(DISK, fixed=True)]},
        {"domain": Box(BoxOptions(lower=(0.0, 0.0), upper=(1.0, 1.6)), 2)},
        {"laws": [law(restitution=0.5)]},
        {"boundary": {"top": Slip}},
    ],
)
def test_a_run_of_another_model_is_neither_resumed_nor_reported(change: dict[str, Any], tmp_path: Path) -> None:
    dry = {"fluid": NoFluid(1.0), "time": TimeTable(end=0.02, step=0.01), "output": OutputTable(every=0.02)}
    run(fall(**dry), tmp_path)
    other = fall(**dry | change)
    with pytest.raises(OutputError, match="a run of another scene"):
        run(other, tmp_path, resume=True)
    with pytest.raises(OutputError, match="results of another model"):
        read_results(tmp_path, model=other)
    assert read_results(tmp_path, model=fall(**dry)).time[-1] == pytest.approx(0.02)


def test_a_model_made_of_that_of_a_scene_is_not_told_by_the_scene() -> None:
    model = model_of(scene_from_dict(TABLES | {"contact": {}}))
    other = replace(model, gravity=(0.0, -50.0))
    assert model.document["fluid"]["gravity"] == [0.0, -1.0]
    assert other.document["model"]["gravity"] == [0.0, -50.0]


def test_a_table_made_in_python_is_refused_as_one_that_is_read() -> None:
    with pytest.raises(SceneError, match=r"TimeTable.step: this key is missing"):
        TimeTable(end=1.0)  # type: ignore[call-arg]
    with pytest.raises(SceneError, match=r"MeshTable.size: found -1.0"):
        MeshTable(size=-1.0, size_body=0.1)
