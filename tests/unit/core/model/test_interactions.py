"""Several laws in a scene: each in the contacts that are its own, forces added up."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

import rigidfluid
from rigidfluid.checks import Finding, check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.schema import json_schema
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.laws.stiffness import greatest_stiffness
from rigidfluid.core.model.interactions import Interaction, SumOfLaws
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.scene.overrides import override
from rigidfluid.errors import PluginError, SceneError, StepError
from rigidfluid.forces.contact import ContactPointLaw, ContactPointOptions
from rigidfluid.forces.lubrication import LubricationLaw, LubricationOptions
from rigidfluid.forces.normal import NormalLaw, NormalOptions

Tables = dict[str, Any]
NORMAL = {"law": "normal", "range": 0.02, "epsilon": 1e-6}
FILM = {"law": "lubrication", "range": 0.01, "viscosity": 0.05, "cutoff": 1e-3}
LEFT = {"name": "left_disk", "type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.3, 0.5]}
RIGHT = LEFT | {"name": "right_disk", "position": [0.7, 0.53]}
TOWARDS = {"velocity": [3.0, 0.0]}, {"velocity": [-3.0, 0.0]}


def tables(*interactions: Tables, contact: Tables | None = None, end: float = 0.2, **more: Any) -> Tables:
    return {
        "scene": {"name": "several", "dimension": 2},
        "fluid": {"backend": "dry"},
        "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]},
        "body": [LEFT | TOWARDS[0], RIGHT | TOWARDS[1]],
        "contact": contact or {},
        "interaction": [dict(interaction) for interaction in interactions],
        "time": {"end": end, "step": 1e-3},
        "output": {"every": 0.05},
    } | more


def run(*interactions: Tables, **more: Any) -> rigidfluid.core.output.history.History:
    return rigidfluid.run(scene_from_dict(tables(*interactions, **more)))


def assert_same(found: Any, expected: Any) -> None:
    for table in ("bodies", "contacts", "energy"):
        ours, wanted = getattr(found, table), getattr(expected, table)
        assert ours.keys() == wanted.keys()
        for column in wanted:
            np.testing.assert_array_equal(ours[column], wanted[column])


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
def test_one_law_for_walls_and_pairs_apart_is_the_one_law_for_all(
    stepping: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(NormalLaw, "pair_formula", lambda _: None)  # all substeps one by one, to the last bit alike
    one = run(contact=NORMAL | {"stepping": stepping}, end=0.4)
    apart = [NORMAL | {"between": between} for between in ("walls", "pairs")]
    assert len({(a, b) for a, b in zip(one.contacts["a"], one.contacts["b"], strict=True)}) > 2
    assert_same(run(*apart, contact={"stepping": stepping}, end=0.4), one)
    assert_same(run(NORMAL, contact={"stepping": stepping}, end=0.4), one)


def test_a_law_in_two_halves_is_the_law() -> None:
    one, half = run(contact=NORMAL), NORMAL | {"epsilon": 2e-6}
    halves = run(half, contact=half)
    for column in ("x", "y", "vx", "vy"):
        np.testing.assert_allclose(halves.bodies[column], one.bodies[column], rtol=0, atol=1e-12)
    np.testing.assert_allclose(halves.energy["contact"], one.energy["contact"], rtol=0, atol=1e-12)


def test_the_law_of_the_contact_table_is_the_first_of_the_list() -> None:
    system = build_system(scene_from_dict(tables(FILM, contact=NORMAL)))
    assert [(one.field, one.law.name) for one in system.interactions] == [
        ("contact", "normal"),
        ("interaction.0", "lubrication"),
    ]


def test_a_law_for_walls_leaves_pairs_alone() -> None:
    at_walls = NORMAL | {"between": "walls"}
    with pytest.raises(StepError, match="left_disk"):
        run(at_walls)
    passing = [LEFT | {"velocity": [-3.0, 0.0]}, RIGHT | {"position": [0.515, 0.5]}]
    history = run(at_walls, body=passing, end=0.1)
    assert set(history.contacts["b"]) == {"left"}
    assert not history.bodies["vx"][history.bodies["body"] == "right_disk"].any()


@pytest.mark.parametrize(
    ("where", "held"),
    [
        ({"names": ["left_disk"]}, {("left_disk", "right_disk"), ("left_disk", "left")}),
        ({"names": ["left_disk"], "between": "walls"}, {("left_disk", "left")}),
        ({"names": ["right_disk", "left_disk"]}, {("left_disk", "right_disk")}),
        ({"names": ["right", "right_disk"]}, {("right_disk", "right")}),
        ({"names": ["left"]}, {("left_disk", "left")}),
        ({"between": "pairs"}, {("left_disk", "right_disk")}),
    ],
)
def test_names_and_kinds_say_where_a_law_acts(where: Tables, held: set[tuple[str, str]]) -> None:
    between = [LEFT | {"position": [0.11, 0.5]}, RIGHT | {"position": [0.89, 0.5]}]
    middle = [LEFT | {"position": [0.3, 0.5]}, RIGHT | {"position": [0.51, 0.5]}]
    found: set[tuple[str, str]] = set()
    for body in (between, middle):
        history = run(NORMAL | where, body=body, end=1e-3)
        found |= set(zip(history.contacts["a"], history.contacts["b"], strict=True))
    assert found == held


def test_lubrication_beside_a_repulsion_dissipates_and_repels() -> None:
    history, one = run(NORMAL, FILM | {"range": 0.02}, end=0.1), run(NORMAL, end=0.1)
    assert history.energy["contact_loss"][-1] > 0.05 * history.energy["kinetic"][0]
    assert history.bodies["gap"].min() > 0.0
    assert history.bodies["vx"][-1] * TOWARDS[1]["velocity"][0] < 0.0
    assert history.energy["kinetic"][-1] < 0.95 * one.energy["kinetic"][-1]
    assert abs(history.summary["energy"]["relative_residual"]) < 2e-3


@pytest.mark.parametrize(("stepping", "most"), [("substeps", 1e-3), ("implicit", 1e-9)])
def test_the_energy_of_dry_bounces_is_closed(stepping: str, most: float) -> None:
    """Of a stiff law at walls and two soft ones side by side of other ranges between bodies."""
    stiff = {"law": "barrier", "range": 0.01, "epsilon": 1e-3, "between": "walls"}
    soft = NORMAL | {"between": "pairs"}
    wide = {"law": "centre", "range": 0.04, "epsilon": 1e-5, "between": "pairs"}
    energy = run(stiff, soft, wide, contact={"stepping": stepping}, end=0.4).energy
    total = energy["kinetic"] + energy["contact"]
    assert energy["contact"].max() > 0.5 * total[0]
    assert abs(total - total[0]).max() < most * total[0]


def test_a_resumed_run_gives_the_same_bits(tmp_path: Path) -> None:
    laws = NORMAL | {"between": "pairs"}, NORMAL | {"between": "walls", "range": 0.03}, FILM
    whole = rigidfluid.run(scene_from_dict(tables(*laws)), tmp_path / "whole")
    rigidfluid.run(scene_from_dict(tables(*laws, end=0.1)), tmp_path / "resumed")
    resumed = rigidfluid.run(scene_from_dict(tables(*laws)), tmp_path / "resumed", resume=True)
    for table in ("bodies", "contacts", "energy"):
        name = f"{table}.csv"
        assert (tmp_path / "whole" / name).read_bytes() == (tmp_path / "resumed" / name).read_bytes()
    assert whole.summary["energy"] == resumed.summary["energy"]


def test_auto_is_computed_for_each_law() -> None:
    auto = NORMAL | {"epsilon": "auto"}
    walls = auto | {"between": "walls", "smallest_gap": 0.002}
    pairs = auto | {"between": "pairs", "smallest_gap": 0.01}
    rows = run(walls, pairs, end=1e-3).summary["auto_epsilon"]
    assert [row["smallest_gap"] for row in rows] == [0.002, 0.01]
    assert [row["between"][1] for row in rows] == ["wall", "right_disk"]
    head_on = [LEFT | TOWARDS[0], RIGHT | TOWARDS[1] | {"position": [0.7, 0.5]}]
    history = run(walls, pairs, body=head_on, end=0.4)
    pair = history.contacts["b"] == "right_disk"
    assert history.contacts["gap"][pair].min() == pytest.approx(0.01, rel=0.02)
    assert history.contacts["gap"][~pair].min() == pytest.approx(0.002, rel=0.1)


def touching(gap: float) -> Contacts:
    one, normal, at_wall = np.ones(1), np.array([[1.0, 0.0]]), np.zeros(1, bool)
    return Contacts(np.zeros(1, int), np.ones(1, int), gap * normal, 0 * normal, normal, gap * one, one, one, at_wall)


def test_the_stiffness_on_the_way_sees_each_range() -> None:
    """`contact` is stiffest at a third of its range, which steps toward a far longer range would pass over."""
    short = ContactPointLaw(ContactPointOptions(epsilon=1e-6), 0.001)
    film = LubricationLaw(LubricationOptions(viscosity=1.0, cutoff=1e-4), 0.1)
    both = SumOfLaws([Interaction(f"interaction.{i}", law, "all", ()) for i, law in enumerate((short, film))])
    assert both.range == 0.1
    alone = greatest_stiffness(short, touching(0.0), np.zeros(1))
    assert alone > 0.0
    np.testing.assert_array_equal(greatest_stiffness(both, touching(0.0), np.zeros(1)), alone)


def test_the_stiffness_on_the_way_is_not_that_further_in() -> None:
    """Where a contact turns before it comes into the shorter range, what lies within is out."""
    long, short = NormalLaw(NormalOptions(epsilon=1e-6), 0.1), NormalLaw(NormalOptions(epsilon=1e-9), 0.001)
    both = SumOfLaws([Interaction(f"interaction.{i}", law, "all", ()) for i, law in enumerate((short, long))])
    deepest = np.full(1, 0.05)
    np.testing.assert_array_equal(greatest_stiffness(both, touching(0.0), deepest), 2.0 * 0.05 / 1e-6)


def test_a_fall_to_the_shortest_range_is_expected() -> None:
    falling = {"body": [LEFT], "fluid": {"backend": "dry", "gravity": [0.0, -10.0]}}
    one, two = (
        build_system(scene_from_dict(tables(NORMAL, *more, **falling))) for more in ([], [NORMAL | {"range": 0.1}])
    )
    np.testing.assert_array_equal(two.loads.speed, one.loads.speed)


def test_auto_is_told_of_the_wall_that_a_law_names() -> None:
    rows = run(NORMAL | {"epsilon": "auto", "names": ["top"]}, end=1e-3).summary["auto_epsilon"]
    assert [row["between"] for row in rows] == [["left_disk", "wall"]]


def test_a_law_is_not_asked_for_contacts_of_others() -> None:
    class Picky(NormalLaw):
        def force(self, contacts: Contacts) -> np.ndarray:
            assert set(contacts.body_b) == {1}
            return super().force(contacts)

    law = Picky(NormalOptions(epsilon=1e-6), 0.02)
    pairs = SumOfLaws([Interaction("interaction.0", law, "pairs", ())])
    pair = touching(0.01)
    wall = replace(pair, body_b=np.full(1, 2), at_wall=np.ones(1, bool))
    assert not pairs.force(wall).any()
    assert pairs.force(pair).any()


@pytest.mark.parametrize(
    ("groups", "acts"),
    [
        ((), [True, True, True, True]),
        (((1, 2),), [True, True, False, True]),
        (((1, 2), (1, 2)), [False, True, False, False]),
        (((0,), (1, 2)), [True, False, False, False]),
        (((1, 2), (4,)), [False, False, False, True]),
        (((), (0,)), [False, False, False, False]),
    ],
)
def test_a_law_acts_between_one_of_each_group(groups: tuple[tuple[int, ...], ...], acts: list[bool]) -> None:
    law = NormalLaw(NormalOptions(epsilon=1e-6), 0.02)
    one, body_a, body_b = np.ones(4), np.array([0, 2, 0, 1]), np.array([1, 1, 3, 4])
    normal = np.tile([1.0, 0.0], (4, 1))
    contacts = Contacts(body_a, body_b, normal, normal, normal, one, one, one, body_b == 4)
    assert Interaction("interaction.0", law, "all", groups).acts_in(contacts).tolist() == acts


STICKING = {"law": "spring-dashpot", "range": 0.02, "stiffness": 1e4, "friction": 0.3, "tangential_stiffness": 1e3}


@pytest.mark.parametrize(
    ("names", "meet"),
    [
        ((["a*"], ["left_disk"]), True),
        ((["a*", "a*"], ["a*", "left_disk"]), False),
        ((["a*", "left_disk"], ["left_disk", "a0"]), True),
        ((["a*", "left_disk"], ["left_disk", "right_disk"]), False),
    ],
)
def test_laws_of_groups_may_meet_where_these_share_bodies(names: tuple[list[str], list[str]], meet: bool) -> None:
    grains = [LEFT | {"name": f"a{n}", "position": [0.3 + 0.3 * n, 0.15]} for n in range(2)]
    given = tables(*(STICKING | {"names": each} for each in names), body=[LEFT, RIGHT, *grains])
    if meet:
        with pytest.raises(SceneError, match="one such law in a contact"):
            build_system(scene_from_dict(given))
    else:
        build_system(scene_from_dict(given))


REFUSED: dict[str, tuple[Tables, str]] = {
    "unknown name": (
        NORMAL | {"names": ["left_dsk"]},
        r"interaction.0.names.0: found 'left_dsk', .*Did you mean 'left_d",
    ),
    "one body": (NORMAL | {"names": ["left_disk"] * 2}, r"interaction.0.names: found .*two different surfaces"),
    "two walls": (NORMAL | {"names": ["left", "top"]}, r"interaction.0.names: found .*one of them a body"),
    "walls of pairs": (NORMAL | {"names": ["left"], "between": "pairs"}, r"names: found \['left'\].*that meet"),
    "pairs at walls": (
        NORMAL | {"names": ["left_disk", "right_disk"], "between": "walls"},
        r"interaction.0.names: found .*that meet",
    ),
    "three names": (NORMAL | {"names": ["left", "top", "right"]}, "interaction.0.names: found .*at most 2"),
    "kind": (NORMAL | {"between": "balls"}, "interaction.0.between: found 'balls'; .*walls"),
    "no range": ({"law": "normal", "epsilon": 1e-6}, "interaction.0.range: this key is missing.*Gap above"),
    "no law": ({"range": 0.02}, "interaction.0.law: this key is missing.*Name of a force law"),
    "gap": (NORMAL | {"smallest_gap": 0.02}, r"interaction.0.smallest_gap: found 0.02; .*interaction.0.range = 0.02"),
    "key of the detector": (
        NORMAL | {"samples": 3},
        r"interaction.0.samples: found a key that nothing reads; .*epsilon",
    ),
    "option": (NORMAL | {"epsilon": -1.0}, "interaction.0.epsilon: found -1.0; .*greater than 0"),
    "cutoff": (FILM | {"cutoff": 0.01}, r"interaction.0.cutoff: found 0.01; .*below interaction.0.range = 0.01"),
    "idle": (NORMAL | {"epsilon": "auto"}, r"interaction.0.epsilon: found \"auto\" with body 'left_disk' that"),
}


@pytest.mark.parametrize(("interaction", "text"), REFUSED.values(), ids=REFUSED)
def test_a_table_that_cannot_be_is_refused(interaction: Tables, text: str) -> None:
    with pytest.raises(SceneError, match=text):
        build_system(scene_from_dict(tables(interaction, body=[LEFT, RIGHT])))


@pytest.mark.parametrize("table", ["contact", "interaction.0"])
def test_a_needed_key_that_is_misspelt_is_told_as_such(table: str) -> None:
    law = {"law": "barrier", "range": 0.02, "epsilonn": 1.0}
    scene = tables(contact=law) if table == "contact" else tables(law)
    with pytest.raises(
        SceneError, match=rf"{table}.epsilonn: found a key that nothing reads; .*Did you mean 'epsilon'"
    ):
        scene_from_dict(scene)


def test_an_unknown_law_is_refused_by_its_table() -> None:
    with pytest.raises(PluginError, match=r"interaction.1.law: found 'norml'; .*Did you mean 'normal'"):
        scene_from_dict(tables(NORMAL, NORMAL | {"law": "norml"}))


def test_a_face_that_is_no_wall_is_refused() -> None:
    outlet = [{"on": "top", "type": "pressure", "pressure": 0.0}]
    with pytest.raises(SceneError, match=r"interaction.0.names.0: found 'top', a surface that is no wall"):
        scene_from_dict(tables(NORMAL | {"names": ["top"]}, boundary=outlet))


def test_parts_of_one_body_are_refused() -> None:
    body = [LEFT | {"part_of": "pair"}, RIGHT | {"part_of": "pair"}]
    with pytest.raises(SceneError, match=r"interaction.0.names: found .*not parts of one articulated body"):
        scene_from_dict(tables(NORMAL | {"names": ["left_disk", "right_disk"]}, body=body))


def test_a_law_for_smooth_bodies_is_for_those_it_names() -> None:
    corners = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]]
    square = {"name": "square", "type": "polygon", "points": corners, "density": 1.0, "position": [0.5, 0.8]}
    body = [LEFT, RIGHT, square]
    scene_from_dict(tables(FILM | {"names": ["left_disk", "right_disk"]}, body=body))
    with pytest.raises(SceneError, match=r"interaction.0.law: found 'lubrication' with bodies of unknown curvature"):
        scene_from_dict(tables(FILM | {"names": ["left_disk", "square"]}, body=body))


def test_an_override_reaches_an_entry_of_the_list() -> None:
    data = tables(NORMAL, FILM)
    override(data, ["interaction.1.range=0.015", "interaction.0.between=pairs"])
    system = build_system(scene_from_dict(data))
    assert system.interactions[1].law.range == 0.015
    assert system.interactions[0].between == "pairs"


def test_a_scene_with_a_lawsreads_back_and_one_without_is_as_ever() -> None:
    scene = scene_from_dict(tables(NORMAL | {"names": ["left_disk"]}, FILM))
    assert scene_from_dict(scene.to_dict()) == scene
    assert "interaction" not in scene_from_dict(tables(contact=NORMAL)).to_dict()


def test_the_schema_takes_the_keys_of_a_law_and_no_others() -> None:
    schema = json_schema()
    jsonschema.validate(scene_from_dict(tables(NORMAL, FILM)).to_dict(), schema)
    for wrong in (NORMAL | {"viscosity": 1.0}, FILM | {"samples": 3}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(tables(wrong), schema)


def findings(*interactions: Tables, question: str, **more: Any) -> list[Finding]:
    report = check(scene_from_dict(tables(*interactions, **more)))
    return [one for one in report.findings if one.question == question]


def test_the_check_asks_each_contact_by_the_laws_that_act_there() -> None:
    unbounded = {"law": "barrier", "range": 0.02, "epsilon": 1e-3, "between": "walls"}
    weak = NORMAL | {"between": "pairs", "epsilon": 1e-2}
    impacts = {one.subject[1]: one for one in findings(unbounded, weak, FILM, question="impact")}
    assert np.isinf(impacts["left"].found["barrier_over_impact"])
    assert impacts["right_disk"].found["barrier_over_impact"] < 1.0
    assert "Set interaction.1.epsilon to" in impacts["right_disk"].remedy
    assert "dampers brake too" in impacts["right_disk"].text


def test_the_check_adds_laws_that_act_side_by_side() -> None:
    half = NORMAL | {"epsilon": 2e-2}
    one, two = (findings(*laws, question="impact") for laws in ([NORMAL | {"epsilon": 1e-2}], [half, half]))
    assert [a.found for a in one] == [pytest.approx(b.found, nan_ok=True) for b in two]
    assert "Make the laws of interaction.0 and interaction.1" in two[0].remedy


def test_the_check_warns_of_contacts_without_a_law() -> None:
    (warning,) = findings(NORMAL | {"between": "walls"}, question="law")
    assert warning.grade == "warning"
    assert warning.subject == ("left_disk", "right_disk")
    assert "no law acts between them" in warning.text
    (film,) = findings(NORMAL | {"between": "walls"}, FILM, question="law")
    assert "interaction.1 only takes energy out" in film.text
    assert not findings(NORMAL, question="law")


def test_the_check_names_the_table_of_a_range() -> None:
    wide = NORMAL | {"range": 0.45, "between": "walls"}
    (thick,) = findings(NORMAL, wide, question="range")
    assert "interaction.1.range" in thick.remedy
    free = findings(NORMAL, wide, question="free-gap")
    assert {one.subject for one in free} == {("left_disk", "left", "right"), ("left_disk", "bottom", "top")}
    assert not findings(NORMAL, wide | {"names": ["left"]}, question="free-gap")
    (started,) = findings(NORMAL, wide | {"epsilon": 1e-9}, question="start")
    assert "interaction.1.range" in started.remedy


def test_what_a_scene_switches_on_says_where() -> None:
    report = check(
        scene_from_dict(tables(NORMAL | {"between": "walls"}, FILM | {"names": ["left_disk", "right_disk"]}))
    )
    (forces,) = (one for one in report.features if one.name == "contact forces")
    wanted = (
        "law 'normal' below a gap of 0.02 at walls; law 'lubrication' below a gap of 0.01 (left_disk and right_disk)"
    )
    assert forces.why == wanted
