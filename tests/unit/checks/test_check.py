"""What `check` asks of a scene, one question at a time, against closed forms."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from paths import ROOT
from typer.testing import CliRunner

from rigidfluid.checks import Finding, Report, check
from rigidfluid.checks.finding import round_down, round_up
from rigidfluid.cli import app
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.pairs.representative_contacts import representatives

RADIUS, RANGE, GRAVITY, HEIGHT = 0.1, 0.02, 10.0, 0.5
MASS = 3.0 * np.pi * RADIUS**2
WEIGHT = MASS * GRAVITY
IMPACT = WEIGHT * HEIGHT
"""Of the fall to range, and of the way from there to contact."""
BALL = {"type": "sphere", "radius": RADIUS, "density": 3.0, "position": [1.0, HEIGHT + RADIUS]}
WET = {"fluid": {"backend": "scikit-fem", "density": 1.0, "viscosity": 0.01, "gravity": [0.0, -GRAVITY]}}
MESH = {"mesh": {"size": 0.2, "size_body": 0.02}}
Install = Callable[..., Path]


def tables(*bodies: dict[str, Any], contact: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
    return {
        "scene": {"name": "asked", "dimension": 2},
        "fluid": {"backend": "dry", "gravity": [0.0, -GRAVITY]},
        "domain": {"lower": [0.0, 0.0], "upper": [2.0, 2.0]},
        "body": list(bodies or (BALL,)),
        "contact": {"law": "normal", "range": RANGE, "epsilon": 1e-7} | (contact or {}),
        "time": {"end": 1.0, "step": 1e-3},
        "output": {"every": 0.1},
    } | more


def report(*bodies: dict[str, Any], **more: Any) -> Report:
    return check(scene_from_dict(tables(*bodies, **more)))


def found(question: str, *bodies: dict[str, Any], **more: Any) -> list[Finding]:
    return [one for one in report(*bodies, **more).findings if one.question == question]


def only(question: str, *bodies: dict[str, Any], **more: Any) -> Finding:
    findings = found(question, *bodies, **more)
    assert len(findings) == 1
    return findings[0]


def spring(stiffness: float, **keys: Any) -> dict[str, Any]:
    return {"law": "spring-dashpot", "range": RANGE, "stiffness": stiffness} | keys


def without_epsilon(contact: dict[str, Any], **more: Any) -> dict[str, Any]:
    """Keyword arguments for a law that reads no ε."""
    data = tables(**more)
    data["contact"] = contact
    return data


def answers(data: dict[str, Any], question: str) -> list[Finding]:
    return [one for one in check(scene_from_dict(data)).findings if one.question == question]


# rest


def test_rest_of_a_law_that_is_strong_enough() -> None:
    finding = only("rest")
    assert finding.grade == "note"
    assert finding.subject == ("body0", "bottom")
    assert finding.found["force_over_weight"] == pytest.approx(RANGE**2 / 1e-7 / WEIGHT)
    assert finding.found["rest_gap"] == pytest.approx(RANGE - np.sqrt(1e-7 * WEIGHT))


def test_rest_of_a_law_that_is_too_weak_names_the_epsilon_that_is_enough() -> None:
    limit = RANGE**2 / WEIGHT
    finding = only("rest", contact={"epsilon": 1.2 * limit})
    assert finding.grade == "error"
    assert finding.found["rest_gap"] == pytest.approx(RANGE * (1 - np.sqrt(1.2)))
    assert finding.enough == {"strength": pytest.approx(1.2), "epsilon_wall": pytest.approx(limit)}
    assert only("rest", contact={"epsilon": 1.2 * limit, "epsilon_wall": 0.999 * limit}).grade == "note"


def test_rest_of_a_spring_needs_strength() -> None:
    (finding,) = answers(without_epsilon(spring(0.5 * WEIGHT / RANGE)), "rest")
    assert finding.enough == {"strength": pytest.approx(2.0)}
    assert "2 times as strong" in finding.remedy
    assert finding.found["rest_gap"] == pytest.approx(-RANGE)


def test_rest_on_a_barrier_is_never_refused() -> None:
    finding = only("rest", contact={"law": "barrier", "epsilon": 1e3})
    assert finding.grade == "note"
    assert finding.found["force_over_weight"] == np.inf
    assert finding.to_dict()["found"]["force_over_weight"] is None
    gap = float(finding.found["rest_gap"])  # type: ignore[arg-type]
    w = RANGE - gap
    assert (2 * w * np.log(RANGE / gap) + w**2 / gap) / 1e3 == pytest.approx(WEIGHT, rel=1e-6)


def test_a_light_body_rests_below_the_ceiling() -> None:
    light = BALL | {"density": 0.5}
    assert only("rest", light, **WET, **MESH).subject == ("body0", "top")


def test_on_a_slope_the_wall_holds_a_part_of_the_weight() -> None:
    aslant = {"fluid": {"backend": "dry", "gravity": [0.6 * GRAVITY, -0.8 * GRAVITY]}}
    assert only("rest", **aslant).found["weight"] == pytest.approx(0.8 * WEIGHT)


def test_nothing_rests_without_weight_or_freedom() -> None:
    assert not found("rest", BALL | {"velocity": [1.0, 0.0]}, fluid={"backend": "dry"})
    assert not found("rest", BALL | {"fixed": True})


def test_a_range_beside_a_blade_is_measured_by_its_thickness() -> None:
    """However thin: the radius of the largest ball in it is half its height here, rounded down."""
    blade = {"type": "polygon", "points": [[0, 0], [0.4, 0], [0.2, 1e-7]], "density": 2.0, "position": [1.0, 1.0]}
    finding = only("range", blade)
    assert finding.found["half_thickness"] == pytest.approx(5e-8, rel=0.01)
    assert finding.remedy.startswith("Set contact.range to 5e-08 or less")


def test_pairs_are_held_by_their_own_epsilon() -> None:
    upper = BALL | {"position": [1.0, 1.5]}
    at_wall, between = found("rest", BALL, upper, contact={"epsilon": 2e-7, "epsilon_wall": 1e-7})
    assert (at_wall.subject, between.subject) == (("body0", "bottom"), ("body0", "body1"))
    ratio = float(at_wall.found["force_over_weight"]) / float(between.found["force_over_weight"])  # type: ignore[arg-type]
    assert ratio == pytest.approx(2.0)


def test_parts_of_one_body_are_no_pair() -> None:
    parts = BALL | {"part_of": "it"}, BALL | {"part_of": "it", "position": [1.0, 1.5]}
    assert [one.subject[1] for one in found("rest", *parts)] == ["bottom"]


# impact


@pytest.mark.parametrize(("share", "grade"), [(1.01, "note"), (0.99, "error"), (0.9999, "error")])
def test_impact_against_what_the_law_stores(share: float, grade: str) -> None:
    epsilon = RANGE**3 / (3 * share * IMPACT)
    finding = only("impact", contact={"epsilon": epsilon})
    assert finding.grade == grade
    assert finding.found["barrier_over_impact"] == pytest.approx(share)
    assert finding.found["impact_speed"] == pytest.approx(np.sqrt(2 * GRAVITY * (HEIGHT - RANGE)))
    if grade == "error":
        assert finding.enough["epsilon_wall"] == pytest.approx(epsilon * share)
        assert f"takes up only {min(share, 0.999)} of the impact" in finding.text


def test_impact_ends_where_the_energy_is_stored() -> None:
    still = {"fluid": {"backend": "dry"}}
    finding = only("impact", BALL | {"velocity": [3.0, 0.0]}, contact={"epsilon": 1e-7}, **still)
    assert finding.found["turning_gap"] == pytest.approx(RANGE - np.cbrt(3e-7 * 0.5 * MASS * 9.0))


def test_impact_of_a_pair_has_its_effective_mass() -> None:
    light = BALL | {"density": 1.0, "position": [1.0, 1.5], "velocity": [0.0, -2.0]}
    findings = found("impact", BALL | {"velocity": [3.0, 0.0]}, light, fluid={"backend": "dry"})
    pair = next(one for one in findings if one.subject[1] == "body1")
    assert pair.found["impact_energy"] == pytest.approx(0.5 * MASS / 4 * 25.0)


@pytest.mark.parametrize("more", [{**WET, **MESH}, {}])
def test_impact_is_a_warning_where_something_else_brakes(more: dict[str, Any]) -> None:
    data = without_epsilon(spring(1.0, **({} if more else {"restitution": 0.5})), **more)
    (finding,) = answers(data, "impact")
    assert finding.grade == "warning"
    assert "film" in finding.text if more else "dampers" in finding.text


@pytest.mark.parametrize(("wanted", "count"), [(0.5 * RANGE, 0), (0.9 * RANGE, 1)])
def test_smallest_gap_is_held_against_the_law(wanted: float, count: int) -> None:
    epsilon = (0.4 * RANGE) ** 3 / (3 * WEIGHT * (HEIGHT - 0.6 * RANGE))  # turns at 0.6 range
    findings = found("smallest-gap", contact={"epsilon": epsilon, "smallest_gap": wanted})
    assert len(findings) == count
    for finding in findings:
        assert finding.found["turning_gap"] == pytest.approx(0.6 * RANGE)
        again = {"epsilon": float(finding.enough["epsilon_wall"]), "smallest_gap": wanted}  # type: ignore[arg-type]
        assert not found("smallest-gap", contact=again)


# step


def frequency(stiffness: float) -> float:
    return float(np.sqrt(stiffness / MASS))


@pytest.mark.parametrize(("turn", "grade"), [(0.49, "note"), (0.51, "warning"), (1.99, "warning"), (2.01, "error")])
def test_fixed_substeps(turn: float, grade: str) -> None:
    stiffness, substeps = 1e4, 4
    step = turn * substeps / frequency(stiffness)
    times = {"time": {"end": 10.0, "step": step}, "output": {"every": 1.0}}
    (finding,) = answers(without_epsilon(spring(stiffness, substeps=substeps), **times), "step")
    assert finding.grade == grade
    assert finding.found["turn_per_substep"] == pytest.approx(turn)
    assert finding.found["contact_time"] == pytest.approx(np.pi / frequency(stiffness))
    if grade != "note":
        assert finding.enough == {"substeps": int(np.ceil(2 * turn * substeps))}


@pytest.mark.parametrize(("turn", "grade"), [(0.49, "note"), (5.0, "warning")])
def test_one_implicit_step(turn: float, grade: str) -> None:
    stiffness = 1e4
    times = {"time": {"end": 10.0, "step": turn / frequency(stiffness)}, "output": {"every": 1.0}}
    (finding,) = answers(without_epsilon(spring(stiffness, stepping="implicit"), **times), "step")
    assert finding.grade == grade
    assert finding.found["turn_per_step"] == pytest.approx(turn)
    if grade != "note":
        assert finding.enough == {"time_step": pytest.approx(0.5 / frequency(stiffness))}


def test_substeps_follow_from_the_stiffness() -> None:
    step = 100.0 / frequency(1e4)
    times = {"time": {"end": 10.0, "step": step}, "output": {"every": 1.0}}
    (finding,) = answers(without_epsilon(spring(1e4), **times), "step")
    assert (finding.grade, finding.found["substeps"]) == ("note", 1024)


@pytest.mark.parametrize(("shortest", "grade"), [(1e-6, "warning"), (1e-3, "error")])
def test_contacts_that_are_too_stiff_to_follow(shortest: float, grade: str) -> None:
    times = {"time": {"end": 1.0, "step": 1e-3, "shortest": shortest}}
    (finding,) = answers(without_epsilon(spring(1e15), **times), "step")
    assert finding.grade == grade
    times = {"time": {"end": 1.0, "step": float(finding.enough["time_step"])}}  # type: ignore[arg-type]
    (again,) = answers(without_epsilon(spring(1e15), **times, output={"every": 1.0}), "step")
    assert again.grade == "note"


def test_stiffness_is_the_greatest_on_the_way_to_the_turning_gap() -> None:
    turning = float(only("impact").found["turning_gap"])  # type: ignore[arg-type]
    assert only("step").found["stiffness"] == pytest.approx(2 * (RANGE - turning) / 1e-7)


# cells


@pytest.mark.parametrize(("refinements", "grade"), [(3, "note"), (2, "warning")])
def test_cells_across_the_gap_at_rest(refinements: int, grade: str) -> None:
    weight = 2.0 * np.pi * RADIUS**2 * GRAVITY  # submerged
    epsilon = (RANGE - 0.25 * RANGE) ** 2 / weight  # rests at range/4 = 0.005
    mesh = {"mesh": {"size": 0.2, "size_body": 0.02, "refinements": refinements}}
    finding = only("cells", contact={"epsilon": epsilon}, **WET, **mesh)
    assert finding.grade == grade
    assert finding.found["gap"] == pytest.approx(0.005)
    assert finding.found["cells"] == pytest.approx(2.0 if refinements == 3 else 1.0)
    if grade == "warning":
        assert finding.enough == {"refinements": 3}


def test_cells_where_no_refinement_is_enough() -> None:
    mesh = {"mesh": {"size": 0.2, "size_body": 0.02, "refinements": 0}}
    weight = 2.0 * np.pi * RADIUS**2 * GRAVITY
    finding = only("cells", contact={"epsilon": (RANGE - 1e-8) ** 2 / weight}, **WET, **mesh)
    assert finding.enough == {"size_body": pytest.approx(5e-9, rel=1e-3)}


def test_no_cells_without_a_mesh() -> None:
    assert not found("cells")


# range


def test_bodies_that_start_within_range() -> None:
    near = BALL | {"position": [1.0, RADIUS + 0.5 * RANGE]}
    still = {"fluid": {"backend": "dry"}}
    finding = only("start", near, **still)
    assert finding.grade == "warning"
    assert finding.found["gap"] == pytest.approx(0.5 * RANGE)
    assert finding.found["energy"] == pytest.approx((0.5 * RANGE) ** 3 / 3e-7)
    assert finding.enough == {"range": pytest.approx(0.5 * RANGE)}
    assert only("start", near | {"velocity": [0.0, -100.0]}, **still).grade == "note"
    assert not found("start", BALL)


def test_a_block_that_lies_within_range_is_one_pair_with_the_floor() -> None:
    corners = [[-RADIUS, -RADIUS], [RADIUS, -RADIUS], [RADIUS, RADIUS], [-RADIUS, RADIUS]]
    block = {"type": "polygon", "points": corners, "density": 1.5, "position": [1.0, RADIUS + 0.5 * RANGE]}
    assert only("start", block, fluid={"backend": "dry"}).found["pairs"] == 1


def test_open_faces_and_parts_of_one_body_do_not_start_within_range() -> None:
    near = BALL | {"position": [1.0, RADIUS + 0.5 * RANGE]}
    assert not found("start", near, boundary=[{"on": "bottom", "type": "slip"}])
    beside = near | {"position": [1.0 + 2 * RADIUS + 0.01, 1.0]}
    parts = [one | {"part_of": "it"} for one in (BALL | {"position": [1.0, 1.0]}, beside)]
    assert found("start", *({key: one[key] for key in one if key != "part_of"} for one in parts))
    assert not found("start", *parts)


def test_range_beside_body_and_cell() -> None:
    coarse = {"size": 0.4, "size_body": 0.32, "refinements": 1}
    body, cell = found("range", contact={"range": 0.15}, **WET, mesh=coarse)
    assert body.enough == {"range": RADIUS}
    assert cell.enough == {"size_body": 0.3}
    assert len(found("range", contact={"range": 0.15}, **WET, mesh=coarse | {"refinements": 2})) == 1
    assert not found("range", contact={"range": 0.05}, **WET, **MESH)


# law, faces


@pytest.mark.parametrize(("more", "grade"), [({}, "error"), ({**WET, **MESH}, "warning")])
@pytest.mark.parametrize("contact", [{}, {"law": "lubrication", "range": 0.02, "viscosity": 0.1, "cutoff": 0.001}])
def test_nothing_keeps_bodies_apart(contact: dict[str, Any], more: dict[str, Any], grade: str) -> None:
    (finding,) = answers(without_epsilon(contact, **more), "law")
    assert finding.grade == grade
    assert "normal" in finding.remedy


def test_a_film_that_the_mesh_resolves_as_well() -> None:
    """h = .005, R = .1 at the floor: h²/R is .00025."""
    film = {"law": "lubrication", "range": 0.02, "viscosity": 0.01, "cutoff": 1e-5}
    more = {**WET, "mesh": {"size": 0.2, "size_body": 0.02, "refinements": 2}}
    (finding,) = answers(without_epsilon(film, **more), "film")
    assert finding.grade == "warning"
    assert finding.enough == {"range": pytest.approx(0.00025)}
    assert not answers(without_epsilon(film | {"range": 0.00025}, **more), "film")
    assert not answers(without_epsilon({"law": "normal", "range": 0.02, "epsilon": "auto"}, **more), "film")
    (finding,) = answers(without_epsilon(film | {"range": 0.00025, "sliding": True}, **more), "film")
    assert (finding.grade, finding.remedy) == ("warning", "Set contact.sliding to false.")


def test_fixed_bodies_need_no_law() -> None:
    (only,) = check(scene_from_dict(tables(BALL | {"fixed": True}) | {"contact": {}})).findings
    assert only.question == "time"


def test_a_face_that_does_not_repel() -> None:
    finding = only("open-face", boundary=[{"on": "bottom", "type": "slip"}])
    assert (finding.grade, finding.subject) == ("warning", ("body0", "bottom"))
    assert not found("open-face", boundary=[{"on": "left", "type": "slip"}])
    assert not found("open-face", boundary=[{"on": face, "type": "periodic"} for face in ("bottom", "top")])
    assert not found("rest", boundary=[{"on": "bottom", "type": "slip"}])


def test_auto_says_what_it_has_chosen() -> None:
    finding = only("auto", contact={"epsilon": "auto"})
    gap = 0.25 * RANGE
    assert finding.found["epsilon"] == pytest.approx((RANGE - gap) ** 3 / 3 / (WEIGHT * (HEIGHT - gap)))
    assert finding.found["smallest_gap"] == gap
    assert only("impact", contact={"epsilon": "auto"}).found["turning_gap"] == pytest.approx(gap)


# many bodies, other laws, the command


def test_equal_bodies_are_asked_once_and_named_by_the_worst() -> None:
    row = [BALL | {"position": [0.2 + 0.3 * i, 0.3 + 0.2 * i]} for i in range(6)]
    at_wall, between = found("impact", *row)
    assert at_wall.subject == ("body5", "bottom")
    assert between.subject == ("body4", "body5")


def test_many_different_bodies_are_asked_at_their_extremes() -> None:
    row = [
        BALL | {"radius": 0.02 + 1e-4 * i, "position": [0.1 + 0.1 * (i % 18), 0.2 + 0.15 * (i // 18)]}
        for i in range(90)
    ]
    assert len(representatives(build_system(scene_from_dict(tables(*row))))) <= 24
    assert found("rest", *row)[0].subject == ("body89", "bottom")


def test_a_third_party_law_is_asked_like_any_other(install: Install, law: str) -> None:
    install(law)
    rest, impact, step = (
        answers(without_epsilon({"law": "springy", "range": 0.5}), q)[0] for q in ("rest", "impact", "step")
    )
    assert rest.found["force_over_weight"] == pytest.approx(0.5 / WEIGHT)
    assert impact.found["barrier_over_impact"] == pytest.approx(0.125 / (WEIGHT * 0.5))
    assert step.found["contact_time"] == pytest.approx(np.pi * np.sqrt(MASS))


@pytest.mark.parametrize(("value", "down", "up"), [(0.46789, "0.467", "0.468"), (1234.0, "1.23e+03", "1.24e+03")])
def test_rounding_to_the_safe_side(value: float, down: str, up: str) -> None:
    assert (round_down(value), round_up(value)) == (down, up)


def write(data: dict[str, Any], folder: Path) -> Path:
    """A scene file; JSON's arrays and inline tables are TOML's, but for the colon."""
    lines = [f"{key} = {_toml(value)}" for key, value in data.items()]
    path = folder / "scene.toml"
    path.write_text("\n".join(lines))
    return path


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_toml(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value)


NUMBERS = {"type": "object", "additionalProperties": {"type": ["number", "null", "string"]}}
FINDING = {
    "properties": {
        "grade": {"enum": ["error", "warning", "note"]},
        "question": {"type": "string"},
        "subject": {"type": "array", "items": {"type": "string"}},
        "text": {"type": "string", "minLength": 1},
        "remedy": {"type": "string"},
        "found": NUMBERS,
        "enough": NUMBERS,
    },
    "required": ["grade", "question", "subject", "text", "remedy", "found", "enough"],
    "additionalProperties": False,
}


@pytest.mark.parametrize(("epsilon", "code"), [(1e-7, 0), (1.0, 1)])
def test_command_writes_json_and_its_exit_code_says_whether_there_are_errors(
    epsilon: float, code: int, tmp_path: Path
) -> None:
    path, written = write(tables(contact={"epsilon": epsilon}), tmp_path), tmp_path / "check.json"
    result = CliRunner().invoke(app, ["check", str(path), "--json", str(written)], env={"COLUMNS": "200"})
    assert result.exit_code == code
    data = json.loads(written.read_text())
    assert list(data) == ["scene", "errors", "warnings", "notes", "domain", "features", "bodies", "pairs", "findings"]
    assert set(data["features"][0]) == {"name", "on", "why"}
    assert data["bodies"][0]["impact_speed"] == pytest.approx(np.sqrt(2 * GRAVITY * (HEIGHT - RANGE)))
    assert (data["bodies"][0]["smallest_gap"], data["bodies"][0]["nearest"]) == (pytest.approx(HEIGHT), "bottom")
    for finding in data["findings"]:
        jsonschema.validate(finding, FINDING)
        assert finding["text"] in result.stdout
    assert data["errors"] == sum(one["grade"] == "error" for one in data["findings"])
    grades = [one["grade"] for one in data["findings"]]
    assert grades == sorted(grades, key=["error", "warning", "note"].index)
    assert f"{data['errors']} errors, {data['warnings']} warnings" in result.stdout


def test_every_warning_and_error_says_what_to_do() -> None:
    weak = report(
        contact={"epsilon": 1.0, "smallest_gap": 0.01, "substeps": 1}, boundary=[{"on": "bottom", "type": "slip"}]
    )
    assert all(one.remedy for one in weak.findings if one.grade != "note")


def test_command_names_the_file_that_it_cannot_write(tmp_path: Path) -> None:
    path = write(tables(), tmp_path)
    result = CliRunner().invoke(app, ["check", str(path), "--json", str(tmp_path / "none" / "check.json")])
    assert result.exit_code == 2
    assert "check.json" in result.stderr


def test_no_mesh_and_no_factorisation(monkeypatch: pytest.MonkeyPatch) -> None:
    import rigidfluid.core.mesh.generation.meshing

    def refused(*_: object, **__: object) -> None:
        raise AssertionError("a mesh")

    monkeypatch.setattr(rigidfluid.core.mesh.generation.meshing, "run_netgen", refused)
    assert report(**WET, **MESH).findings


def test_a_long_list_of_bodies_is_cut(tmp_path: Path) -> None:
    row = [BALL | {"position": [0.15 + 0.25 * (i % 7), 0.2 + 0.25 * (i // 7)]} for i in range(25)]
    text = CliRunner().invoke(app, ["check", str(write(tables(*row), tmp_path))], env={"COLUMNS": "200"}).stdout
    assert "and 5 bodies that are further from anything" in text
    assert sum(line.startswith("│ body") and "sphere" in line for line in text.splitlines()) == 20


def test_every_question_and_figure_is_explained() -> None:
    page = (ROOT / "docs" / "check.md").read_text(encoding="utf-8")
    near = BALL | {"position": [1.0, RADIUS + 0.5 * RANGE]}
    weak = {"epsilon": 1.0, "epsilon_wall": 1.0, "smallest_gap": 0.01}
    coarse = {"mesh": {"size": 0.2, "size_body": 0.16, "refinements": 0}}
    reports = [
        report(contact=weak | {"substeps": 1, "range": 0.15}, **WET, **coarse),
        report(near, BALL | {"position": [1.0, 0.5]}, contact={"epsilon": "auto"}, **WET, **MESH),
        report(
            contact=weak, boundary=[{"on": "bottom", "type": "slip"}], domain={"lower": [0.8, 0.0], "upper": [1.2, 2.0]}
        ),
        report(contact={"epsilon": 1e-12}, **WET, **MESH),
        check(scene_from_dict(tables() | {"contact": {}})),
    ]
    findings = [one for each in reports for one in each.to_dict()["findings"]]
    words = {word for one in findings for word in (one["question"], *one["found"], *one["enough"])}
    words |= {word for each in reports[0].to_dict()["bodies"] for word in each}
    assert {"rest", "impact", "smallest-gap", "step", "cells", "start", "range", "law", "open-face", "auto"} <= words
    assert {"stack", "energy-error", "force_over_stacked_weight", "layer_error"} <= words
    assert sorted(word for word in words if f"`{word}`" not in page) == []


# stacks

UPPER = BALL | {"position": [1.0, 1.5]}
LIGHT, HEAVY = BALL | {"density": 1.0, "position": [1.0, 0.2]}, BALL | {"density": 400.0}
HEAVY_WEIGHT = 400.0 / 3.0 * WEIGHT


def test_what_the_lower_body_bears_at_a_wall() -> None:
    finding = found("stack", BALL, UPPER)[0]
    assert (finding.grade, finding.subject) == ("note", ("body0", "bottom"))
    assert finding.found["stacked_weight"] == pytest.approx(2 * WEIGHT)
    assert finding.found["force_over_stacked_weight"] == pytest.approx(RANGE**2 / 1e-7 / (2 * WEIGHT))
    assert finding.found["rest_gap"] == pytest.approx(RANGE - np.sqrt(1e-7 * 2 * WEIGHT))
    assert only("rest", BALL).found["rest_gap"] == found("rest", BALL, UPPER)[0].found["rest_gap"]


def test_a_wall_that_holds_each_body_but_not_the_stack() -> None:
    share = 0.7
    (finding,) = found("stack", BALL, UPPER, contact={"epsilon_wall": RANGE**2 / (share * 2 * WEIGHT)})
    assert (finding.grade, finding.subject) == ("warning", ("body0", "bottom"))
    assert finding.found["force_over_stacked_weight"] == pytest.approx(share)
    assert finding.enough["epsilon_wall"] == pytest.approx(RANGE**2 / (2 * WEIGHT))
    (again,) = found("stack", BALL, UPPER, contact={"epsilon_wall": 0.99 * RANGE**2 / (2 * WEIGHT)})
    assert again.grade == "note"


def test_a_wall_that_cannot_hold_one_body_is_not_asked_for_the_stack() -> None:
    weak = {"epsilon_wall": 1.1 * RANGE**2 / WEIGHT}
    assert found("rest", BALL, UPPER, contact=weak)[0].grade == "error"
    assert found("stack", BALL, UPPER, contact=weak) == []


def test_bodies_that_hold_each_other_but_not_a_third() -> None:
    three = [BALL | {"position": [1.0, 0.3 + 0.4 * i]} for i in range(3)]
    weak = found("stack", *three, contact={"epsilon": RANGE**2 / (1.5 * WEIGHT), "epsilon_wall": 1e-7})
    assert [(one.grade, one.subject) for one in weak] == [
        ("warning", ("body0", "body1")),
        ("note", ("body0", "bottom")),
    ]
    assert weak[0].found["stacked_weight"] == pytest.approx(2 * WEIGHT)
    assert weak[0].enough["epsilon"] == pytest.approx(RANGE**2 / (2 * WEIGHT))


def test_the_lower_body_may_be_any_of_its_kind() -> None:
    """In a thick fluid all fall alike, so that no speed tells the lowest."""
    thick = {"fluid": WET["fluid"] | {"viscosity": 100.0}}
    row = [BALL | {"position": [1.0, 0.15 + 0.26 * i]} for i in (3, 4, 5, 0, 6, 2, 1)]
    (at_wall, _) = found("stack", *row, **thick, **MESH)
    assert at_wall.subject == ("body3", "bottom")


def test_auto_holds_a_heavy_body_on_a_light_one() -> None:
    stacks = found("stack", LIGHT, HEAVY, contact={"epsilon": "auto"})
    assert [(one.grade, one.subject) for one in stacks] == [("note", ("body0", "bottom"))]
    assert stacks[0].found["stacked_weight"] == pytest.approx(HEAVY_WEIGHT * (1 + 1 / 400))


def test_impact_of_a_stack_is_that_of_all_its_bodies() -> None:
    alone, both = WEIGHT * HEIGHT, WEIGHT * (HEIGHT + 1.5 - RADIUS)
    share = 0.9
    at_wall, _ = found("impact", BALL, UPPER, contact={"epsilon_wall": RANGE**3 / (3 * share * both)})
    assert (at_wall.grade, at_wall.subject) == ("warning", ("body0", "bottom"))  # each body alone is stopped
    assert "come down" in at_wall.text
    assert at_wall.found["pair_energy"] == pytest.approx(alone - WEIGHT * RANGE)
    assert at_wall.found["impact_energy"] == pytest.approx(both - 2 * WEIGHT * RANGE)
    assert at_wall.found["barrier_over_impact"] == pytest.approx(share)
    at_wall, _ = found("impact", BALL, UPPER, contact={"epsilon_wall": RANGE**3 / (3 * 0.9 * alone)})
    assert at_wall.grade == "error"


def test_cells_across_the_gap_under_a_stack() -> None:
    submerged = 2.0 * np.pi * RADIUS**2 * GRAVITY
    at_wall, between = found("cells", BALL, UPPER, contact={"epsilon": 1e-5}, **WET, **MESH)
    assert at_wall.found["gap"] == pytest.approx(RANGE - np.sqrt(1e-5 * 2 * submerged))
    assert between.found["gap"] == pytest.approx(RANGE - np.sqrt(1e-5 * submerged))


def test_auto_stops_a_stack_at_the_smallest_gap() -> None:
    for finding in found("impact", LIGHT, HEAVY, contact={"epsilon": "auto"}):
        assert finding.found["turning_gap"] == pytest.approx(0.25 * RANGE)


def test_the_check_asks_a_law_at_as_many_gaps_as_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """The law `contact` is stiffest at 2/3 of its range, which lies between two of the gaps."""
    from rigidfluid.core.contact.laws import stiffness

    scene = tables(contact={"law": "contact", "epsilon": 1e-12})
    (finding,) = answers(scene, "step")
    gap = float(answers(scene, "impact")[0].found["turning_gap"])  # type: ignore[arg-type]
    gaps = gap + np.arange(stiffness.SAMPLES) / stiffness.SAMPLES * (RANGE - gap)
    asked = (RANGE - gaps) * (3 * gaps - RANGE) / 1e-12
    assert finding.found["stiffness"] == pytest.approx(asked.max(), rel=1e-6)
    assert asked.max() < RANGE**2 / 3 / 1e-12 * 0.9999


def test_a_polygon_is_told_by_its_facets_volume_and_centre() -> None:
    corners = [[3.0, 1.0], [3.4, 1.0], [3.4, 1.1], [3.1, 1.1], [3.1, 1.2], [3.0, 1.2]]
    shape = {"type": "polygon", "points": corners, "density": 3.0}
    answer = only("shape", shape | {"position": [0.5, 0.5]}, shape | {"position": [1.5, 0.5]})
    assert answer.grade == "note"
    assert answer.subject == ("body0",)
    expected = {"facets": 6, "volume": 0.05, "centre_x": (0.04 * 3.2 + 0.01 * 3.05) / 0.05, "centre_y": 1.07}
    assert answer.found == pytest.approx(expected)
    assert found("shape", BALL) == []


def test_a_law_without_losses_is_told_what_balls_in_liquids_do():
    thrown = BALL | {"velocity": [0.0, -1.0]}
    contact = {"impact_speed": 2.0}
    finding = only("rebound", thrown, contact=contact, **WET, **MESH)
    stokes = (3.0 + 1.0) * 2.0 * RADIUS * 2.0 / (9.0 * 0.01)
    assert finding.grade == "note"
    assert finding.found["stokes_number"] == pytest.approx(stokes)
    assert finding.found["rebound"] == pytest.approx(np.exp(-35.0 / stokes))
    assert "contact.restitution" in finding.text


@pytest.mark.parametrize(("refinements", "resolved"), [(0, 0.004), (5, 0.02**2 / 1024 / RADIUS)])
def test_a_film_that_is_resolved_down_to_the_range_needs_no_other_loss(refinements: int, resolved: float):
    mesh = {"size": 0.2, "size_body": 0.02, "refinements": refinements}
    finding = only("rebound", contact={"impact_speed": 0.1, "range": 0.003}, **WET, mesh=mesh)
    assert finding.found["resolved"] == pytest.approx(resolved)
    assert ("restitution_stokes" in finding.text) == (refinements == 0)


def test_what_the_mesh_resolves_of_films_of_facets_is_not_known():
    square = {"type": "polygon", "points": [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]], "density": 3.0}
    contact = {"law": "contact", "epsilon": "auto", "impact_speed": 0.1}
    finding = only("rebound", square | {"position": [1.0, 0.5]}, contact=contact, **WET, **MESH)
    assert "resolved" not in finding.found
    assert "restitution_stokes" in finding.text


def test_slow_impacts_in_a_liquid_do_not_come_back():
    finding = only("rebound", contact={"impact_speed": 0.1}, **WET, **MESH)
    assert finding.found["rebound"] == 0.0
    assert "do not come back" in finding.text


def test_a_law_that_gives_back_what_should_not_come_back_is_warned_of_with_a_range_that_mends_it():
    contact = {"impact_speed": 1.0, "epsilon": "auto", "range": 0.07}
    finding = only("rebound", contact=contact, **WET, **MESH)
    assert finding.grade == "warning"
    assert finding.found["stokes_number"] < 10.0
    assert finding.found["comes_back"] > 0.1
    assert finding.enough["restitution_stokes"] == 35.0
    mended = only("rebound", contact=contact | {"range": finding.enough["range"]}, **WET, **MESH)
    assert mended.grade == "note"
    assert mended.found["comes_back"] < 0.1
    unresolved = {"mesh": {"size": 0.2, "size_body": 0.03, "refinements": 0}}
    assert "range" not in only("rebound", contact=contact, **WET, **unresolved).enough


@pytest.mark.parametrize("contact", [{"restitution": 0.8}, {"restitution_stokes": 35.0}])
def test_a_law_with_losses_is_told_nothing(contact):
    assert not found("rebound", contact=contact | {"impact_speed": 0.1}, **WET, **MESH)
