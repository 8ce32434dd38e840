"""What a scene may say, and what it is told when it says something else."""

from __future__ import annotations

import copy
import tomllib
import weakref
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from paths import SCENES

import rigidfluid
from rigidfluid import load_scene
from rigidfluid.bodies.sphere import Sphere
from rigidfluid.checks import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.case.schema import json_schema
from rigidfluid.core.case.system import build_system
from rigidfluid.core.fluid.conditions import NoSlip, PrescribedPressure, PrescribedVelocity, Slip
from rigidfluid.core.scene.overrides import override
from rigidfluid.core.scene.scene import Scene
from rigidfluid.domains.box import NAMES
from rigidfluid.errors import ArgumentError, PluginError, SceneError
from rigidfluid.registry import Registry

SCENE_FILES = sorted(SCENES.glob("*.toml"))
DRY = SCENES / "dry_bounce.toml"

DISK = {
    "scene": {"name": "disk", "dimension": 2},
    "fluid": {"backend": "scikit-fem", "density": 1, "viscosity": 0.1, "gravity": [0.0, -981.0]},
    "domain": {"lower": [0.0, 0.0], "upper": [2.0, 6.0]},
    "body": [{"type": "sphere", "radius": 0.125, "density": 1.25, "position": [1.0, 4.0]}],
    "contact": {"law": "centre", "range": 0.015, "epsilon": 7e-5},
    "mesh": {"size": 0.15, "size_body": 0.01},
    "time": {"end": 1.0, "step": 0.001},
    "output": {"every": 0.02},
}
SECOND = {"type": "sphere", "radius": 0.125, "density": 1.0, "position": [1.0, 2.0]}
ELLIPSE = {"type": "ellipsoid", "semi_axes": [0.1, 0.2], "density": 1.0, "position": [1.0, 1.0]}
LOW = {"lower": [0.0, 0.0], "upper": [2.0, 1.0], "size": 0.05}
DELETE = object()


def changed(changes: dict[str, Any], base: dict[str, Any] = DISK) -> dict[str, Any]:
    """The tables of a falling disk, with values set or deleted at dotted paths."""
    data = copy.deepcopy(base)
    for path, value in changes.items():
        *parents, key = path.split(".")
        table: Any = data
        for parent in parents:
            table = table[int(parent)] if isinstance(table, list) else table.setdefault(parent, {})
        if value is DELETE:
            del table[key]
        elif isinstance(table, list):
            table.insert(int(key), value)
        else:
            table[key] = value
    return data


def in_3d(**changes: Any) -> dict[str, Any]:
    """A falling ball."""
    base = {"scene.dimension": 3, "fluid.gravity": [0, -981, 0], "domain.lower": [0, 0, 0], "domain.upper": [2, 6, 2]}
    return changed(changes, changed(base | {"body.0.position": [1, 4, 1]}))


@pytest.mark.parametrize("path", SCENE_FILES, ids=lambda path: path.stem)
def test_our_scenes_load_build_and_fit_the_schema(path: Path) -> None:
    scene = load_scene(path)
    build_system(scene)
    assert scene_from_dict(scene.to_dict()) == scene
    jsonschema.validate(tomllib.loads(path.read_text()), json_schema())
    jsonschema.validate(scene.to_dict(), json_schema())


def test_schema_is_valid_and_refuses_what_the_loader_refuses() -> None:
    jsonschema.Draft7Validator.check_schema(json_schema())
    for keys in nested_keys(json_schema()):  # of later drafts, which editors do not know
        assert keys not in ("unevaluatedProperties", "prefixItems", "dependentRequired")
    for changes in ({"body.0.raduis": 1.0}, {"body.0.density": -1.0}, {"contact.epsilon": "much"}, {"fluid.x": 1}):
        assert not jsonschema.Draft7Validator(json_schema()).is_valid(changed(changes))


def nested_keys(schema: Any) -> Iterator[str]:
    """All keys in a schema."""
    for value in schema.values() if isinstance(schema, dict) else schema if isinstance(schema, list) else ():
        yield from nested_keys(value)
    yield from schema if isinstance(schema, dict) else ()


def test_misspelt_keys_are_refused_by_the_schema_of_the_table_itself() -> None:
    """Editors stop at a table's `additionalProperties`, whatever its conditions say."""
    definitions = json_schema()["$defs"]
    for name in ("FluidTable", "BodyTable", "ContactTable", "DomainTable", "MechanismTable", "JointTable"):
        assert definitions[name]["additionalProperties"] is False
    assert {"radius", "semi_axes", "density"} <= definitions["BodyTable"]["properties"].keys()
    boundary = json_schema()["properties"]["boundary"]["items"]
    assert boundary["properties"]["type"]["enum"] == ["periodic", "pressure", "slip", "symmetry", "velocity", "wall"]
    valid = jsonschema.Draft7Validator(json_schema()).is_valid
    assert valid(changed({"boundary": [{"on": "all", "type": "wall"}]}))
    for wrong in ({"type": "wal"}, {"type": "wall", "pressure": 1.0}, {"type": "wall", "velocty": [0.0, 0.0]}, {}):
        assert not valid(changed({"boundary": [{"on": "all", **wrong}]}))


BAD = {
    "unknown key": ({"mesh.sise": 1.0}, "mesh.sise", "size_body", "Did you mean 'size'?"),
    "unknown key of a part": ({"body.0.raduis": 0.1}, "body.0.raduis", "radius", "Did you mean 'radius'?"),
    "misspelt needed key": (
        {"body.0.density": DELETE, "body.0.densty": 1.0},
        "body.0.densty",
        "density",
        "Did you mean 'density'?",
    ),
    "unknown nested key": (
        {"body.0.prescribed": {"frequncy": 1.0}},
        "body.0.prescribed.frequncy",
        "frequency",
        "Did you mean 'frequency'?",
    ),
    "unknown contact key": ({"contact.epsilonn": 1.0}, "contact.epsilonn", "epsilon_wall", "Did you mean 'epsilon'?"),
    "missing key": ({"body.0.density": DELETE}, "body.0.density: this key is missing", "Density", "Add 'density'"),
    "missing option": ({"body.0.radius": DELETE}, "body.0.radius: this key is missing", "Radius", "Add 'radius'"),
    "wrong type": ({"time.end": "soon"}, "time.end: found 'soon'", "a valid number", "ends"),
    "a truth value is no number": ({"time.end": True}, "time.end: found True", "a valid number", "ends"),
    "text is no number": ({"time.end": "1.0"}, "time.end: found '1.0'", "a valid number", "ends"),
    "infinite": ({"time.end": float("inf")}, "time.end: found inf", "finite", "ends"),
    "out of proportion": ({"domain.upper": [1e308, 1.0]}, "domain.upper.0: found 1e+308", "1e+30", "units"),
    "next to nothing": ({"body.0.density": 1e-310}, "body.0.density: found 1e-310", "1e-30", "units"),
    "an option out of proportion": ({"contact.epsilon": 1e-310}, "contact.epsilon: found 1e-310", "1e-30", "units"),
    "more cells than any": ({"domain.upper": [1e6, 1e6]}, "mesh.size: found 0.15", "at least", "Coarsen"),
    "negative density": ({"body.0.density": -1.0}, "body.0.density: found -1", "greater than 0", "Density of the body"),
    "negative radius": ({"body.0.radius": -1.0}, "body.0.radius: found -1", "greater than 0", "Correct"),
    "not a choice": (
        {"fluid.model": "euler"},
        "fluid.model: found 'euler'",
        "'navier-stokes' or 'stokes'",
        "Equations",
    ),
    "wrong length": ({"fluid.gravity": [0.0, 0.0, -981.0]}, "fluid.gravity", "2 numbers", "2 dimensions"),
    "neither body nor fluid": (
        {"body": [], "fluid.backend": "dry", **dict.fromkeys(("fluid.density", "fluid.viscosity"), DELETE)},
        "body: found nothing",
        "a body or a mechanism",
        "[[mechanism]]",
    ),
    "empty box": ({"domain.upper": [2.0, 0.0]}, "domain.upper: found [2.0, 0.0]", "above domain.lower", "Swap"),
    "probe outside": ({"output.probes": [[3.0, 0.0]]}, "output.probes.0: found [3.0, 0.0]", "domain", "Move"),
    "3D face": (
        {"boundary": [{"on": "front", "type": "wall"}]},
        "boundary.0.on: found 'front'",
        "left",
        "Name a surface",
    ),
    "velocity missing": ({"boundary": [{"on": "left", "type": "velocity"}]}, "boundary.0.velocity", "value", "Add"),
    "pressure of a wall": (
        {"boundary": [{"on": "left", "type": "wall", "pressure": 0.0}]},
        "boundary.0.pressure: pressure is valid only with type = 'pressure', not 'wall'",
        "type = 'pressure'",
        "Leave it out, or set type = 'pressure'.",
    ),
    "inflow without outlet": (
        {"boundary": [{"on": "left", "type": "velocity", "velocity": [1.0, 0.0]}]},
        "boundary: found a net inflow of 6",
        "as much outflow",
        "type = 'pressure'",
    ),
    "quaternion in 2D": ({"body.0.orientation": [1, 0, 0, 0]}, "body.0.orientation", "no quaternion", "`angle`"),
    "three numbers for a quaternion": (
        {"body.0.orientation": [1, 0, 0]},
        "body.0.orientation: found [1, 0, 0]",
        "4 entries",
        "quaternion",
    ),
    "no numbers for a quaternion": (
        {"body.0.orientation": []},
        "body.0.orientation: found []",
        "4 entries",
        "quaternion",
    ),
    "a number of 401 digits": ({"body.0.density": 10**400}, "body.0.density: found 1000", "finite", "Density"),
    "a number of 5000 digits": (
        {"body.0.density": 10**5000},
        "scene: found a value that is no JSON",
        "digits",
        "values",
    ),
    "fixed and moving": ({"body.0.fixed": True, "body.0.velocity": [1, 0]}, "body.0.fixed", "one of them", "Remove"),
    "prescribed and moving": (
        {"body.0.prescribed": {"velocity": [1, 0]}, "body.0.velocity": [1, 0]},
        "body.0.velocity",
        "has its velocities there",
        "Move it",
    ),
    "amplitude alone": (
        {"body.0.prescribed": {"amplitude": [1, 0]}},
        "body.0.prescribed.frequency",
        "together",
        "Add 'frequency'",
    ),
    "doubled name": (
        {"body.0.name": "a", "body.1": {**SECOND, "name": "a"}},
        "body.1.name: found 'a'",
        "no other body",
        "Rename",
    ),
    "name of a face": ({"body.0.name": "top"}, "body.0.name: found 'top'", "surface", "Rename"),
    "law without range": ({"contact.range": DELETE}, "contact.range: found nothing", "above 0", "Add"),
    "range without law": (
        {"contact": {"range": 1.0}},
        "contact.range: found 1.0 without a law",
        "`law`",
        "Name the law",
    ),
    "option without law": ({"contact": {"epsilon": 1.0}}, "contact.epsilon", "law", "Name the law"),
    "rare output": ({"output.every": 1e-4}, "output.every: found 0.0001", "time.step = 0.001", "Write less"),
    "long step": ({"time.step": 2.0, "output.every": 3.0}, "time.step: found 2", "time.end = 1", "Shorten"),
    "no tolerance": ({"time.tolerance": 0.0}, "time.tolerance: found 0.0", "0.000001", "Correct"),
    "tolerance without a fluid": (
        {"time.tolerance": 1e-3, "fluid.backend": "dry"},
        "time.tolerance: found 0.001",
        "none with backend 'dry'",
        "Remove",
    ),
    "shortest too long": ({"time.shortest": 0.1}, "time.shortest: found 0.1", "time.step = 0.001", "Shorten"),
    "wall coarser than mesh": ({"mesh.size_wall": 0.2}, "mesh.size_wall: found 0.2", "mesh.size = 0.15", "Refine it"),
    "body coarser than mesh": ({"mesh.size_body": 0.2}, "mesh.size_body: found 0.2", "mesh.size = 0.15", "Swap"),
    "mesh regenerated too often": (
        {"mesh.remesh_every": 1e-4},
        "mesh.remesh_every: found 0.0001",
        "time.step = 0.001",
        "less often",
    ),
    "coarse wake": (
        {"mesh.wake": {"time": 0.1, "size": 0.2}},
        "mesh.wake.size: found 0.2",
        "mesh.size = 0.15",
        "Refine it",
    ),
    "wake of no size": (
        {"mesh.wake": {"time": 0.1}},
        "mesh.wake.size: this key is missing",
        "mesh.wake",
        "Edge length",
    ),
    "coarse refined box": ({"mesh.refine": [LOW | {"size": 0.2}]}, "mesh.refine.0.size", "mesh.size = 0.15", "Refine"),
    "flat refined box": ({"mesh.refine": [LOW | {"upper": [2, 0]}]}, "mesh.refine.0.lower", "below that", "Swap"),
    "refined box in 3D": ({"mesh.refine": [LOW | {"upper": [2, 1, 1]}]}, "mesh.refine.0.upper", "2 numbers", "2 dim"),
    "refined box outside": (
        {"mesh.refine": [LOW, {"lower": [0, -2], "upper": [2, -1], "size": 0.1}]},
        "mesh.refine.1: found one from [0.0, -2.0] to [2.0, -1.0]",
        "meets the domain, which reaches from [0.0, 0.0] to [2.0, 6.0]",
        "Move",
    ),
    "refined box of too many cells": ({"mesh.refine": [LOW | {"size": 1e-6}]}, "mesh.refine.0.size", "4.47", "Coarsen"),
    "no viscosity": ({"fluid.viscosity": DELETE}, "fluid.viscosity: found nothing", "scikit-fem", "Add 'viscosity'"),
    "no mesh": ({"mesh": DELETE}, "mesh: found nothing", "scikit-fem", "Add [mesh]"),
    "carriage return in a name": ({"body.0.name": "a\rb"}, "body.0.name: found 'a\\rb'", "no control", "Name in"),
    "escape in a name": ({"body.0.name": "a\x1b[31m"}, "body.0.name: found 'a\\x1b", "no control", "Name in"),
    "star in a name": (
        {"body.0.name": "a*"},
        "body.0.name: found 'a*'",
        "no `*`, which stands for all numbers",
        "Name in",
    ),
    "unsafe name": ({"scene.name": "../x"}, "scene.name: found '../x'", "letters, digits", "Name of the scene"),
}


@pytest.mark.parametrize(("changes", "field", "allowed", "remedy"), BAD.values(), ids=BAD)
def test_bad_value_is_refused(changes: dict[str, Any], field: str, allowed: str, remedy: str) -> None:
    with pytest.raises(SceneError) as caught:
        scene_from_dict(changed(changes))
    message = str(caught.value)
    assert message.startswith(field)
    assert allowed in message
    assert remedy in message
    assert "\n" not in message
    assert len(message) < 1000


BAD_GEOMETRY = {
    "lost in the box": (
        {"domain.lower": [-1e12, -1e12], "domain.upper": [1e12, 1e12], "mesh.size": 1e11},
        "body.0",
        "at least 1e-08",
    ),
    "outside": ({"body.0.position": [1.0, 7.0]}, "body.0.position", "overlaps surface 'top' of the domain by 1.125"),
    "through a wall": (
        {"body.0.position": [0.1, 3.0]},
        "body.0.position",
        "overlaps surface 'left' of the domain by 0.025",
    ),
    "in another": (
        {"body.1": {**SECOND, "position": [1.0, 3.8]}},
        "body.0.position",
        "body 'body0' overlaps body 'body1' by 0.05",
    ),
    "through an outlet": (
        {"boundary": [{"on": "right", "type": "pressure", "pressure": 0.0}], "body.0.position": [2.0, 3.0]},
        "body.0.position",
        "overlaps surface 'right'",
    ),
    "mesh too coarse": (
        {"body.0.position": [1.0, 0.1251], "mesh.size_body": 0.1, "mesh.refinements": 1},
        "mesh.size_body",
        "less than 0.0141",
    ),
}


@pytest.mark.parametrize(("changes", "field", "text"), BAD_GEOMETRY.values(), ids=BAD_GEOMETRY)
def test_bad_geometry_is_refused(changes: dict[str, Any], field: str, text: str) -> None:
    scene = scene_from_dict(changed(changes))
    with pytest.raises(SceneError) as caught:
        build_system(scene)
    assert caught.value.subject == field
    assert text in str(caught.value)


def test_a_scene_file_is_named_by_a_path() -> None:
    with pytest.raises(ArgumentError, match=r"path: found None; allowed is a path\. Give a scene file"):
        load_scene(None)  # type: ignore[arg-type]


def test_the_advised_size_is_accepted() -> None:
    build_system(
        scene_from_dict(changed({"body.0.position": [1.0, 0.1251], "mesh.size_body": 0.0141, "mesh.refinements": 1}))
    )


@pytest.mark.parametrize(
    ("changes", "subject"),
    [
        ({"fluid.backend": "scikit-fen"}, "fluid.backend"),
        ({"body.0.type": "sphare"}, "body.0.type"),
        ({"contact.law": "center"}, "contact.law"),
        ({"contact.detector": "spheer"}, "contact.detector"),
    ],
)
def test_unknown_part_is_refused(changes: dict[str, Any], subject: str) -> None:
    with pytest.raises(PluginError, match=r"allowed is one of .* Did you mean") as caught:
        scene_from_dict(changed(changes))
    assert caught.value.subject == subject


def test_error_of_a_body_names_its_number() -> None:
    second = {"type": "ellipsoid", "semi_axes": [0.1, 0.1, 0.1], "density": 1.0, "position": [1.0, 1.0]}
    with pytest.raises(SceneError) as caught:
        scene_from_dict(changed({"body.1": second}))
    assert caught.value.subject == "body.1.semi_axes"


@pytest.mark.parametrize(
    ("content", "text"), [(None, "No such file"), (b"[scene", "invalid TOML"), (b"a = \xff", "invalid TOML")]
)
def test_unreadable_file_is_refused(tmp_path: Path, content: bytes | None, text: str) -> None:
    path = tmp_path / "scene.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(SceneError, match=text) as caught:
        load_scene(path)
    assert caught.value.subject == str(path)


@pytest.mark.parametrize(
    "text", ["a = " + "[" * 5000, "a = " + "9" * 5000, "a" + ".a" * 3000 + " = 1", "a = " + "{a=" * 2000]
)
def test_toml_that_python_cannot_hold_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(text)
    with pytest.raises(SceneError, match=r"scene.toml: found invalid TOML|a value that is no JSON"):
        load_scene(path)
    key, _, value = text.partition(" = ")
    with pytest.raises(SceneError):
        load_scene(SCENE_FILES[0], [f"{key}={value}"])


def test_folder_is_no_scene(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"which is a folder; allowed is a regular file\. Name a file"):
        load_scene(tmp_path)


@pytest.mark.parametrize(
    ("assignment", "path", "value"),
    [
        ("contact.range=0.02", ("contact", "range"), 0.02),
        ("body.0.density = 1.5", ("body", 0, "density"), 1.5),
        ("fluid.model=stokes", ("fluid", "model"), "stokes"),
        ('scene.name="a b"', ("scene", "name"), "a b"),
        ("fluid.gravity=[0, 1]", ("fluid", "gravity"), [0, 1]),
        ("body.0.fixed=true", ("body", 0, "fixed"), True),
        ("new.key=1", ("new", "key"), 1),
    ],
)
def test_override(assignment: str, path: tuple[Any, ...], value: object) -> None:
    data: Any = copy.deepcopy(DISK)
    override(data, [assignment])
    for key in path:
        data = data[key]
    assert data == value


@pytest.mark.parametrize(
    ("assignment", "text"),
    [
        ("time.end", "key=value"),
        (".=1", "key=value"),
        ("time..end=1", "key=value"),
        ("time.end=a=b", "a TOML value, or one word"),
        ("time.end=1\ntime.step=1", "a TOML value, or one word"),
        ("body.1.density=1", "a number from 0 to 0"),
        ("body.x=1", "a number from 0 to 0"),
        ("time.end.x=1", "a key of a table"),
    ],
)
def test_bad_override_is_refused(assignment: str, text: str) -> None:
    with pytest.raises(SceneError) as caught:
        override(copy.deepcopy(DISK), [assignment])
    assert text in str(caught.value)


def test_defaults() -> None:
    scene = scene_from_dict(changed({"body.1": {**SECOND, "position": [1, 2]}, "contact": {}}))
    assert [body.name for body in scene.body] == ["body0", "body1"]
    assert scene.time.shortest == 0.001 / 1024
    system = build_system(scene)
    assert system.law is None
    assert system.detector.name == "sphere"
    assert [wall.name for wall in system.walls] == ["left", "right", "bottom", "top"]


def test_detector_for_other_shapes() -> None:
    assert build_system(scene_from_dict(changed({"body.1": ELLIPSE, "contact": {}}))).detector.name == "ellipsoid"


def test_an_endless_box_is_refused_without_a_mesher() -> None:
    """Netgen ends the whole process where the difference of two corners overflows."""
    box = {"lower": [-1e308, -1e308], "upper": [1e308, 1e308]}
    with pytest.raises(SceneError, match=r"domain.lower.0: found -1e\+308"):
        scene_from_dict(changed({"domain": box}))


def test_a_law_for_balls_refuses_other_shapes() -> None:
    with pytest.raises(SceneError, match=r"contact.law: found 'centre' with bodies that are no balls"):
        scene_from_dict(changed({"body.1": ELLIPSE}))


def test_numpy_values_are_accepted() -> None:
    assert scene_from_dict(changed({"body.0.position": np.array([1.0, 4.0])})) == scene_from_dict(DISK)


def test_system_in_2d() -> None:
    system = build_system(scene_from_dict(changed({"body.0.angle": 0.3, "body.0.angular_velocity": 2.0})))
    area = np.pi * 0.125**2
    np.testing.assert_allclose(system.mass, [1.25 * area])
    np.testing.assert_allclose(system.inertia, [[[1.25 * area * 0.125**2 / 2]]])
    np.testing.assert_allclose(system.weight, [[0.0, -981 * 0.25 * area]])
    np.testing.assert_array_equal(system.pose.orientation, [[0.3]])
    np.testing.assert_array_equal(system.twist.angular_velocity, [[2.0]])
    assert not system.prescribed.any()


@pytest.mark.parametrize("work", [rigidfluid.run, check, build_system], ids=lambda work: work.__name__)
def test_plug_ins_are_looked_up_once_and_each_body_is_built_once(
    work: Callable[[Scene], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    counts: Counter[str] = Counter()

    def counted(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        return lambda *given: counts.update([name]) or function(*given)

    monkeypatch.setattr(Registry, "load", counted("lookups", Registry.load))
    monkeypatch.setattr(Sphere, "__init__", counted("bodies", Sphere.__init__))
    work(load_scene(DRY, ["time.end=2e-5", "output.every=2e-5"]))
    assert counts == {"lookups": 1, "bodies": 2}


def test_an_equal_scene_has_a_model_of_its_own() -> None:
    """It may have been read where other plug-ins were installed; and only the latest is kept."""
    one, other = scene_from_dict(DISK), scene_from_dict(DISK)
    assert model_of(one) is model_of(one)
    assert model_of(other).bodies[0] is not model_of(one).bodies[0]
    kept = weakref.ref(model_of(other).bodies[0])
    model_of(one)
    assert kept() is None


def test_system_in_3d() -> None:
    system = build_system(scene_from_dict(in_3d(**{"body.0.orientation": [0, 0, 2, 0], "body.0.velocity": [1, 2, 3]})))
    np.testing.assert_allclose(system.mass, [1.25 * 4 / 3 * np.pi * 0.125**3])
    np.testing.assert_array_equal(system.pose.orientation, [[0, 0, 1, 0]])
    np.testing.assert_array_equal(system.twist.velocity, [[1, 2, 3]])
    assert system.inertia.shape == (1, 3, 3)
    assert system.surfaces == ("body0", "left", "right", "bottom", "top", "back", "front")
    front = system.walls[5].shape.plane
    np.testing.assert_array_equal(front.unit_normal, [0, 0, -1])
    np.testing.assert_array_equal(front.point[2], 2.0)


@pytest.mark.parametrize(
    ("name", "other"), list(zip(NAMES, ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax"), strict=True))
)
def test_faces_are_named_by_axis_too(name: str, other: str) -> None:
    slips = [
        [type(condition) is Slip for condition in model_of(scene_from_dict(in_3d(boundary=tables))).conditions]
        for tables in ([{"on": on, "type": "slip"}] for on in (name, other))
    ]
    assert slips[0] == slips[1]
    assert sum(slips[0]) == 1


def test_the_name_that_a_scene_uses_of_a_face_is_shown() -> None:
    law = {"law": "barrier", "range": 0.1, "epsilon": 1.0}
    for named, asked in (("zmin", "back"), ("back", "zmin")):
        scene = in_3d(boundary=[{"on": named, "type": "wall"}], interaction=[{**law, "names": [asked]}])
        model = model_of(scene_from_dict(scene))
        shown = "zmin"  # it is used in one of the tables
        assert shown in model.surfaces
        assert shown in [condition.name for condition in model.conditions]
        assert (shown,) in [law.names for law in model.laws]
    assert "back" in model_of(scene_from_dict(in_3d(boundary=[{"on": "back", "type": "wall"}]))).surfaces


@pytest.mark.parametrize(
    "domain",
    [
        {
            "type": "channel",
            "lower": [0.0, 0.0],
            "upper": [2.0, 6.0],
            "obstacle": [{"name": "pin", "type": "sphere", "radius": 0.1, "position": [1.0, 1.0]}],
        },
        {"type": "stenosis", "length": 12.0, "width": 10.0, "radius": 1.0},
    ],
)
def test_meshes_of_domains_with_a_box_in_them_know_both_names(domain: dict[str, Any]) -> None:
    tables = changed({"domain": domain, "boundary": [{"on": "xmax", "type": "slip"}]})
    model = model_of(scene_from_dict(tables))
    assert model.domain.names[:3] == ("left", "xmax", "bottom")
    assert {side.name for side in model.domain.cad_shape(1.0).edges} >= {"left", "xmax", "bottom", "top"}


def test_a_part_of_a_box_has_the_same_names() -> None:
    box = model_of(scene_from_dict(changed({"boundary": [{"on": "xmax", "type": "slip"}]}))).domain
    part = box.between(1, 0.5, 5.0)
    assert part is not None
    assert part.names == box.names == ("left", "xmax", "bottom", "top")


@pytest.mark.parametrize(
    "wrong",
    [
        {"boundary": [{"on": "zmim", "type": "wall"}]},
        {"interaction": [{"law": "barrier", "range": 0.1, "epsilon": 1.0, "names": ["zmim"]}]},
    ],
)
def test_both_names_of_faces_are_told_where_another_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(SceneError, match=r"zmim.*back or zmin, front or zmax"):
        scene_from_dict(in_3d(**wrong))


@pytest.mark.parametrize(
    "wrong",
    [
        {"boundary": [{"on": "zmim", "type": "wall"}]},
        {"interaction": [{"law": "barrier", "range": 0.1, "epsilon": 1.0, "names": ["zmim"]}]},
    ],
)
def test_the_nearest_name_of_a_face_is_suggested(wrong: dict[str, Any]) -> None:
    with pytest.raises(SceneError, match=r"Did you mean 'zmin'\?"):
        scene_from_dict(in_3d(**wrong))


def test_walls_are_told_before_many_bodies() -> None:
    law = {"law": "barrier", "range": 0.1, "epsilon": 1.0, "names": ["nix"]}
    row = [SECOND | {"name": f"disk{n}", "radius": 0.02, "position": [0.05 + 0.08 * n, 1.0]} for n in range(21)]
    with pytest.raises(SceneError, match=r"one of left or xmin, .*disk0, .*, …\. Name a body"):
        scene_from_dict(changed({"interaction": [law], "body": row}))


def test_angle_in_3d_is_refused() -> None:
    with pytest.raises(SceneError, match=r"body\.0\.angle.*quaternion"):
        scene_from_dict(in_3d(**{"body.0.angle": 1.0}))


def test_prescribed_motion_is_the_derivative_of_the_displacement() -> None:
    motion = {"velocity": [1.0, 0.0], "angular_velocity": 0.5, "amplitude": [0.0, 0.2], "frequency": 3.0}
    system = build_system(scene_from_dict(changed({"body.0.prescribed": motion, "body.1": {**SECOND, "fixed": True}})))
    assert system.prescribed.all()
    np.testing.assert_allclose(system.twist.velocity[0], [1.0, 0.2 * 6 * np.pi])
    step = 1e-6
    displacement = [0.2 * np.sin(6 * np.pi * t) for t in (0.4 - step, 0.4 + step)]
    expected = [[1.0, np.diff(displacement)[0] / (2 * step), 0.5], [0.0, 0.0, 0.0]]
    np.testing.assert_allclose(system.prescribed_twist(0.4), expected, rtol=1e-8)


def test_later_boundaries_override_earlier_ones() -> None:
    boundary = [
        {"on": "all", "type": "symmetry"},
        {"on": "left", "type": "velocity", "velocity": [0.3, 0.0], "profile": "parabolic"},
        {"on": "right", "type": "pressure", "pressure": 2.0},
        {"on": "top", "type": "wall"},
    ]
    scene = scene_from_dict(changed({"boundary": boundary}))
    left, right, bottom, top = model_of(scene).conditions
    assert [type(c) for c in (left, right, bottom, top)] == [PrescribedVelocity, PrescribedPressure, Slip, NoSlip]
    assert [c.surface for c in (left, right, bottom, top)] == [1, 2, 3, 4]
    points = np.array([[0.0, 0.0], [0.0, 1.5], [0.0, 3.0]])
    np.testing.assert_allclose(left.velocity(0.0, points), [[0, 0], [0.225, 0], [0.3, 0]])
    np.testing.assert_array_equal(right.pressure(0.0, points), [2, 2, 2])
    assert [wall.name for wall in build_system(scene).walls] == ["top"]


def test_balanced_inflow_needs_no_outlet() -> None:
    through = [{"on": face, "type": "velocity", "velocity": [1.0, 0.0]} for face in ("left", "right")]
    scene_from_dict(changed({"boundary": through}))


def test_mean_of_a_parabolic_profile_in_3d() -> None:
    inlet = [{"on": "left", "type": "velocity", "velocity": [1, 0, 0], "profile": "parabolic"}]
    outlet = [{"on": "right", "type": "velocity", "velocity": [4 / 9, 0, 0]}]
    scene_from_dict(in_3d(boundary=inlet + outlet))


def test_angular_velocity_in_3d() -> None:
    given = in_3d(**{"body.0.angular_velocity": [0.1, 0.2, 0.3]})
    np.testing.assert_array_equal(build_system(scene_from_dict(given)).twist.angular_velocity, [[0.1, 0.2, 0.3]])
    given = in_3d(**{"body.0.prescribed": {"angular_velocity": [0.1, 0.2, 0.3]}})
    np.testing.assert_array_equal(build_system(scene_from_dict(given)).twist.angular_velocity, [[0.1, 0.2, 0.3]])
