"""Laws that must not act in one contact are refused."""

import pytest
from extreme_scenes import wet_hit
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.errors import SceneError

ROUGH = {"law": "normal", "range": 0.02, "epsilon": 1e-3, "restitution": 0.9, "roughness": 1e-4}
FILM = {"law": "lubrication", "range": 0.02, "viscosity": 0.1, "cutoff": 1e-4}


def scene(rough: str, film: str):
    tables = wet_hit({}).to_dict()
    del tables["contact"]
    return scene_from_dict(tables | {"interaction": [ROUGH | {"between": rough}, FILM | {"between": film}]})


@pytest.mark.parametrize(("rough", "film"), [("all", "all"), ("walls", "all"), ("all", "pairs"), ("walls", "walls")])
def test_a_film_is_not_counted_twice(rough: str, film: str) -> None:
    with pytest.raises(SceneError, match="counted once") as refused:
        build_system(scene(rough, film))
    assert refused.value.subject == "interaction.1.law"


def test_a_film_law_may_act_in_other_contacts() -> None:
    system = build_system(scene("walls", "pairs"))
    assert [interaction.law.film for interaction in system.interactions] == [False, True]


ELLIPSE = {"name": "ellipse", "type": "ellipsoid", "semi_axes": [0.1, 0.05], "density": 1.0, "position": [0.5, 0.7]}


@pytest.mark.parametrize(
    ("where", "refused"),
    [
        ({}, True),
        ({"between": "pairs"}, True),
        ({"between": "walls"}, True),
        ({"names": ["disk"]}, True),
        ({"names": ["bottom"]}, True),
        ({"names": ["disk", "bottom"]}, False),
        ({"names": ["disk"], "between": "walls"}, False),
    ],
)
def test_friction_that_resists_rolling_is_for_round_surfaces(where: dict, refused: bool) -> None:
    disk = {"name": "disk", "type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.5, 0.3]}
    rolling = RUBBING | where | {"rolling_friction": 0.1}
    scene = scene_from_dict(dry_tables(disk, ELLIPSE) | {"interaction": [rolling]})
    if refused:
        with pytest.raises(SceneError, match=r"neither round nor flat.* Set it to 0, or keep the law") as told:
            build_system(scene)
        assert told.value.subject == "interaction.0.rolling_friction"
        scene = scene_from_dict(dry_tables(disk, ELLIPSE) | {"interaction": [rolling | {"rolling_friction": 0.0}]})
    assert build_system(scene).law is not None


@pytest.mark.parametrize("sliding", [True, False])
def test_a_film_that_resists_sliding_is_for_surfaces_of_known_curvature(sliding: bool) -> None:
    """Ellipses, and walls that are flat or round; the obstacle is neither."""
    film, names = FILM | {"sliding": sliding}, [["ellipse", "island"], ["ellipse", "bottom"]]
    island = ELLIPSE | {"name": "island", "position": [1.5, 0.5]}
    obstacle = {key: island[key] for key in ("name", "type", "semi_axes", "position")}
    domain = {"type": "channel", "lower": [0.0, 0.0], "upper": [2.0, 1.0], "obstacle": [obstacle]}

    def built(*pairs: list[str]):
        given = [film | {"names": pair} for pair in pairs]
        return build_system(scene_from_dict(dry_tables(ELLIPSE, domain=domain) | {"interaction": given}))

    assert built(names[1]).has_curved_films == sliding
    if not sliding:
        assert built(*names).law is not None
        return
    with pytest.raises(SceneError, match=r"of unknown curvature; .*Set it to false, or keep the law") as told:
        built(*names)
    assert told.value.subject == "interaction.0.sliding"


RUBBING = {"law": "normal", "range": 0.02, "epsilon": 1e-3, "friction": 0.5}
BRAKES = {
    "a film": (FILM | {"sliding": True}, "law"),
    "friction without memory": (
        {"law": "spring-dashpot", "range": 0.02, "stiffness": 1e3, "friction": 0.5},
        "friction",
    ),
}


@pytest.mark.parametrize(("brake", "key"), BRAKES.values(), ids=BRAKES)
def test_springs_along_surfaces_and_another_brake_in_one_contact_need_substeps(brake: dict, key: str) -> None:
    """Implicit steps would bound the sum of both by the friction of the springs."""
    disk = {"name": "disk", "type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.5, 0.3]}

    def built(stepping: str, between: str):
        laws = [RUBBING | {"between": "walls"}, brake | {"between": between}]
        return build_system(
            scene_from_dict(dry_tables(disk) | {"contact": {"stepping": stepping}, "interaction": laws})
        )

    with pytest.raises(SceneError, match=r"resists sliding where interaction\.0") as refused:
        built("implicit", "all")
    assert refused.value.subject == f"interaction.1.{key}"
    for stepping, between in (("substeps", "all"), ("implicit", "pairs")):
        assert built(stepping, between).law.sticking


def test_a_second_friction_with_springs_in_a_contact_is_told_by_its_key() -> None:
    disk = {"name": "disk", "type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.5, 0.3]}
    with pytest.raises(SceneError, match=r"a spring along surfaces that interaction\.0") as refused:
        build_system(scene_from_dict(dry_tables(disk) | {"interaction": [RUBBING, RUBBING]}))
    assert refused.value.subject == "interaction.1.friction"
