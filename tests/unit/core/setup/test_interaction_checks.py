"""Laws that must not act in one contact are refused."""

import pytest
from extreme_scenes import wet_hit

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
