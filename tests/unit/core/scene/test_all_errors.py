"""All errors of a scene at once, each with its place in the file."""

from __future__ import annotations

import pickle
import re
import tomllib
from pathlib import Path

import pytest
from paths import SCENES
from typer.testing import CliRunner

from rigidfluid import load_scene, scene_from_dict
from rigidfluid.cli import app
from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.scene.places import line_of
from rigidfluid.errors import PluginError, RigidfluidError, SceneError, SceneErrors

SIX = """\
[scene]
name = "six"
dimension = 2

[fluid]
density = "one"
viscosity = 0.1

[domain]
type = "box"
lower = [0.0, 0.0]
uper = [2.0, 6.0]

[[body]]
type = "disk"
radius = 0.125
density = 1.25
position = [1.0, 4.0]

[[body]]
type = "sphere"
radius = 0.125
density = 1.25
position = [
  1.0,
  2.0,
  3.0,
]

[contact]
law = "center"
range = 0.015
epsilon = 7e-5

[mesh]
size = 0.15
size_body = 0.01

[time]
step = 0.001

[output]
every = 0.02
"""
PLACES = {
    "fluid.density": 6,
    "domain.uper": 12,
    "body.0.type": 15,
    "body.1.position": 24,
    "contact.law": 31,
    "time.end": 39,
}


def errors_of(text: str, tmp_path: Path, *assignments: str) -> tuple[RigidfluidError, ...]:
    path = tmp_path / "scene.toml"
    path.write_text(text)
    with pytest.raises((SceneError, PluginError)) as caught:
        load_scene(path, assignments)
    return caught.value.errors if isinstance(caught.value, SceneErrors) else (caught.value,)


def test_six_mistakes_are_told_at_once_with_their_lines_in_the_order_of_the_file(tmp_path: Path) -> None:
    found = {error.subject: error.place for error in errors_of(SIX, tmp_path)}
    assert found == {field: f"{tmp_path / 'scene.toml'}:{line}" for field, line in PLACES.items()}
    assert list(found) == list(PLACES)


def test_the_command_tells_each_in_a_line(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(SIX)
    result = CliRunner().invoke(app, ["check", str(path)])
    assert result.exit_code == 2
    head, *lines = result.stderr.splitlines()
    assert head == "Error: 6 errors"
    assert lines[0].startswith(f"{path}:6: fluid.density: found 'one'; allowed is a valid number.")
    assert "Did you mean 'sphere'?" in lines[2]
    assert len(lines) == 6


def test_a_single_error_is_itself_with_its_line(tmp_path: Path) -> None:
    text = (SCENES / "falling_disk.toml").read_text().replace("radius = 0.125", "raduis = 0.125")
    (error,) = errors_of(text, tmp_path)
    assert type(error) is SceneError
    assert str(error).startswith(
        f"{tmp_path / 'scene.toml'}:{text.splitlines().index('raduis = 0.125           # cm') + 1}: "
    )


def test_a_value_of_the_command_line_is_named_as_such(tmp_path: Path) -> None:
    text = (SCENES / "falling_disk.toml").read_text()
    found = errors_of(text, tmp_path, "body.0.density=-1", "time.step=no", "body.0.spring.stifness=3")
    assert [error.place for error in found] == [
        "--set body.0.density=-1", "--set body.0.spring.stifness=3", "--set time.step=no",
    ]  # fmt: skip


def test_what_the_model_refuses_comes_together_too(tmp_path: Path) -> None:
    text = (SCENES / "falling_disk.toml").read_text()
    text = text.replace('law = "centre"\n', 'law = "centre"\nstrength = 3\n').replace('on = "all"', 'on = "floor"')
    text = text.replace("density = 1.0            # g/cm²\n", "").replace('"sphere"\nradius', '"ball"\nradius')
    expected = ["fluid.density", "boundary.0.on", "body.0.type", "contact.strength"]
    assert [error.subject for error in errors_of(text, tmp_path)] == expected


def test_errors_that_a_check_finds_later_have_their_line(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text((SCENES / "dry_bounce.toml").read_text().replace("[0.7, 0.55]", "[0.3, 0.55]"))
    line = path.read_text()[: path.read_text().index("[0.3, 0.5]")].count("\n") + 1
    for command in ("check", "run"):
        result = CliRunner().invoke(app, [command, str(path)])
        assert f"{path}:{line}: body.0.position: " in result.stderr, result.stderr


@pytest.mark.parametrize(
    ("field", "line"),
    [
        ("body.1.position.2", 24 + 3),
        ("body.1", 20),
        ("body.1.spring.rest", 20),
        ("body.1, body 'a.b'.name", 20),
        ("mesh.size, line 3, column 'x'", 36),
        ("mesh.size", 36),
        ("body 'disk'", None),
        ("--set", None),
        ("body.7", 14),
    ],
)
def test_lines(field: str, line: int | None) -> None:
    assert line_of(field, SIX.splitlines()) == line


def test_lines_within_lists_and_texts_of_several_lines() -> None:
    text = (
        '[scene]\nname = """a\n[b]\n"""\n\n# rows\nrows = [\n  [1, 2],\n  { x = 1 },\n  [[\n    3\n  ]],\n]\nlast = 1\n'
    )
    fields = {"scene.name": 4, "scene.rows": 7, "scene.rows.1": 9, "scene.rows.1.x": 9, "scene.rows.2.0.0": 11}
    assert {field: line_of(field, text.splitlines()) for field in fields} == fields
    assert line_of("scene.last", text.splitlines()) == 14


def test_no_line_where_the_text_is_not_toml() -> None:
    assert line_of("scene.name", ["[scene", "name = 1"]) is None


def test_questions_are_all_asked_and_the_same_error_is_told_once() -> None:
    def refuse(field: str) -> None:
        raise SceneError(field, 1, "2", "Mend it.")

    def ask_all(*fields: str) -> None:
        with all_told() as ask:
            assert ask(len, "abc") == 3
            for field in fields:
                ask(refuse, field)

    ask_all()
    with pytest.raises(SceneErrors) as caught:
        ask_all("b", "a", "b")
    assert [error.subject for error in caught.value.errors] == ["b", "a"]
    with pytest.raises(SceneError, match=r"^b: "):
        ask_all("b", "b")


def test_errors_pass_between_processes() -> None:
    error = SceneError("body.0.type", 1, "2", "Mend it.")
    error.place = "scene.toml:3"
    both = SceneErrors([error, PluginError("contact.law", 1, "2", "Mend it.")])
    assert str(pickle.loads(pickle.dumps(both))) == str(both)
    assert "scene.toml:3: body.0.type" in str(both)


DIFFERENT_KINDS = """\
[scene]
name = "six"
dimension = 2

[fluid]
backend = "scikit-fenics"
densty = 1.0
density = 1.0
viscosity = 0.1

[domain]
lower = [0.0, 0.0]
upper = [2.0, 6.0]

[[boundary]]
on = "topp"
type = "wall"

[[body]]
name = "refused"
type = "sphere"
radius = -0.125
density = 1.25
position = [1.0, 2.0]

[[body]]
name = "one"
type = "sphere"
radius = 0.125
density = 1.25
position = [1.0, 4.0]

[[body]]
name = "one"
type = "sphere"
radius = 0.125
density = 1.25
position = [1.1, 4.0]

[[body]]
name = "outside"
type = "sphere"
radius = 0.125
density = 1.25
position = [3.0, 4.0]

[mesh]
size = 0.15
size_body = 0.01

[time]
end = 1.0
step = 0.001
"""
PLACES_OF_KINDS = {
    "fluid.backend": 6,
    "fluid.densty": 7,
    "boundary.0.on": 16,
    "body.0.radius": 22,
    "body.1.position": 31,
    "body.2.name": 34,
    "body.3.position": 45,
}


@pytest.mark.parametrize("output", ["", "\n[output]\nevery = 0.02\n"])
def test_mistakes_of_different_kinds_are_told_together_each_in_its_line(tmp_path: Path, output: str) -> None:
    errors = {error.subject: error.place for error in errors_of(DIFFERENT_KINDS + output, tmp_path)}

    path = tmp_path / "scene.toml"
    missing = {} if output else {"output": str(path)}
    assert errors == {subject: f"{path}:{line}" for subject, line in PLACES_OF_KINDS.items()} | missing


def test_doubled_names_do_not_hide_overlaps(tmp_path: Path) -> None:
    valid = DIFFERENT_KINDS.replace("fenics", "fem").replace("densty = 1.0\n", "").replace("topp", "top")
    text = valid.replace("-0.125", "0.125") + "[output]\nevery = 0.02\n"

    assert [error.subject for error in errors_of(text, tmp_path)] == [
        "body.1.position",
        "body.2.name",
        "body.3.position",
    ]


def test_every_body_that_overlaps_is_told(tmp_path: Path) -> None:
    valid = DIFFERENT_KINDS.replace("fenics", "fem").replace("densty = 1.0\n", "").replace("topp", "top")
    path = tmp_path / "scene.toml"
    path.write_text(valid.replace("-0.125", "0.125").replace('"one"', '"two"', 1) + "[output]\nevery = 0.02\n")

    told = CliRunner().invoke(app, ["check", str(path)])

    assert told.exit_code == 2
    assert [line.partition(": ")[0] for line in told.stderr.splitlines()[1:]] == [f"{path}:30", f"{path}:44"]


def test_every_pair_that_overlaps_is_told(tmp_path: Path) -> None:
    told = check_heap([0.1, 0.4, 0.25], tmp_path)

    pairs = re.findall(r"body '(\d)' overlaps \w+ '(\w+)'.*? by (\S+);.*Move it by more than \3", told)
    assert pairs == [("0", "2", "0.25"), ("0", "left", "0.1"), ("0", "1", "0.1"), ("1", "2", "0.25")]
    assert told.startswith("Error: 4 errors\n")


def test_beyond_the_ten_deepest_overlaps_their_number_is_told(tmp_path: Path) -> None:
    first, *pairs, last = check_heap([1.0 + 0.01 * n for n in range(6)], tmp_path).splitlines()

    assert first == "Error: 11 errors"
    assert len(pairs) == 10
    assert "further overlaps: found 5 more, by 0.37 at most; " in last
    assert "Mend the 10 deepest" in last


def check_heap(places: list[float], tmp_path: Path) -> str:
    """What `check` says of a heap that it refuses."""
    path = tmp_path / "scene.toml"
    path.write_text(heap(places))
    told = CliRunner().invoke(app, ["check", str(path)])
    assert told.exit_code == 2
    return told.stderr


def heap(places: list[float]) -> str:
    """Disks of a radius of .2 in a row, at these places."""
    bodies = [
        f'[[body]]\nname = "{n}"\ntype = "sphere"\nradius = 0.2\ndensity = 1.0\nposition = [{x}, 1.0]\n'
        for n, x in enumerate(places)
    ]
    return "\n".join([HEAP, *bodies])


HEAP = """\
[scene]
name = "heap"
dimension = 2

[fluid]
backend = "dry"

[domain]
lower = [0.0, 0.0]
upper = [3.0, 2.0]

[time]
end = 1.0
step = 0.001

[output]
every = 0.02
"""


def test_misspelt_names_of_periodic_surfaces_are_told_before_pairs_are_missed() -> None:
    data = tomllib.loads((SCENES / "periodic_channel.toml").read_text(encoding="utf-8"))
    data["boundary"][0]["on"] = "lefft"
    data["boundary"].append({"on": "botom", "type": "slip"})
    with pytest.raises(SceneErrors) as errors:
        scene_from_dict(data)
    assert [error.subject for error in errors.value.errors] == ["boundary.0.on", "boundary.2.on"]


@pytest.mark.parametrize(
    ("key", "value", "allowed", "remedy"),
    [
        ("boundary", {"on": "all"}, "a list of tables", "[[boundary]] in front"),
        ("body", {"name": "disk"}, "a list of tables", "[[body]] in front"),
        ("domain.lower", 0.0, "a list", "in brackets: [0.0]"),
        ("swarm", "many", "a list of tables", "[[swarm]] in front"),
    ],
)
def test_a_single_value_in_the_place_of_a_list(key: str, value: object, allowed: str, remedy: str) -> None:
    scene = tomllib.loads((SCENES / "rebound.toml").read_text())
    table, _, last = key.rpartition(".")
    (scene[table] if table else scene)[last] = value
    with pytest.raises(SceneError, match=re.escape(remedy)) as error:
        scene_from_dict(scene)
    assert str(error.value).startswith(f"{key}: found")
    assert f"allowed is {allowed}. " in str(error.value)
