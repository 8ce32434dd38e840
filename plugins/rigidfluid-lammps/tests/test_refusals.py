"""Scenes that LAMMPS cannot run exactly as rigidfluid does are refused by the key."""

from __future__ import annotations

from typing import Any

import pytest
from dry_scenes import ball, dry_scene

from rigidfluid.api import scene_from_dict
from rigidfluid_lammps import CrosscheckError, crosscheck

Tables = dict[str, Any]
NORMAL = {"law": "normal", "range": 0.02, "epsilon": 1e-6}
STICKING = {
    **{"law": "spring-dashpot", "range": 0.02, "stiffness": 1e5, "friction": 0.5},
    **{"tangential_stiffness": 1e5},
}
ROLLING = STICKING | {"rolling_friction": 0.1}
FILM = {"law": "lubrication", "range": 0.01, "viscosity": 0.05, "cutoff": 1e-3}
DIPOLES = {
    **{"law": "dipole", "range": 2.0, "strength": 1e-6, "names": ["one", "other"]},
    **{"moments": [[1.0, 0.0], [1.0, 0.0]]},
}
ONE, OTHER = ball([0.3, 0.5], [0.0, 0.0], name="one"), ball([0.8, 0.8], [0.0, 0.0], name="other")
UNMOVED, SHAPELESS = ({key: ONE[key] for key in ONE if key != left_out} for left_out in ("velocity", "radius"))
SWIMMER = {
    **{"name": "it", "type": "three_sphere_swimmer", "position": [0.5, 0.5], "density": 1.0},
    **{"radius": 0.05, "arms": 0.2, "amplitude": 0.02, "speed": 1.0},
}
BELT = {"on": "bottom", "type": "wall", "velocity": [0.5, 0.0]}

REFUSED: dict[str, tuple[str, Tables]] = {
    "an ellipse": ("body.0.type", {"body": [SHAPELESS | {"type": "ellipsoid", "semi_axes": [0.1, 0.05]}]}),
    "a prescribed motion": ("body.0.prescribed", {"body": [UNMOVED | {"prescribed": {"velocity": [0.1, 0.0]}}]}),
    "an articulated body": ("body.0.part_of", {"body": [ONE | {"part_of": "it"}, OTHER | {"part_of": "it"}]}),
    "a held direction": ("body.0.free", {"body": [ONE | {"free": ["x"], "velocity": [0.1, 0.0]}]}),
    "a mechanism": ("mechanism: .*Leave mechanisms out", {"body": [], "mechanism": [SWIMMER]}),
    "a joint": ("joint: ", {"joint": [{"type": "hinge", "between": ["one", "other"], "at": [0.5, 0.5]}]}),
    "a sink": ("sink: found bodies that enter or leave", {"sink": [{"on": "bottom"}]}),
    "a wall that slides": ("domain: found the wall 'bottom'", {"boundary": [BELT]}),
    "a film": ("contact.law: found 'lubrication'", {"contact": FILM}),
    "a film, elsewhere": ("interaction.0.law: found 'lubrication'", {"interaction": [FILM]}),
    "friction of rolling": ("contact.rolling_friction", {"contact": ROLLING}),
    "a bounded dashpot": ("contact.bounded_dashpot: found true", {"contact": STICKING | {"restitution": 0.5}}),
    "a bounded dashpot of its own": ("contact.bounded_dashpot", {"contact": STICKING | {"damping": 1.0}}),
    "a damper": ("contact.restitution: found 0.5", {"contact": NORMAL | {"restitution": 0.5}}),
    "a damper, elsewhere": ("interaction.0.restitution", {"interaction": [NORMAL | {"restitution": 0.5}]}),
    "friction": ("contact.friction: found 0.5", {"contact": NORMAL | {"friction": 0.5}}),
    "friction of rolling, elsewhere": ("interaction.0.rolling_friction", {"interaction": [ROLLING]}),
    "two laws": ("interaction: found 2 interactions", {"interaction": [NORMAL, FILM]}),
    "a long-range force": ("interaction: found a long-range force", {"interaction": [DIPOLES]}),
    "a law for some": ("interaction: found 1 interactions", {"interaction": [NORMAL | {"between": "walls"}]}),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_has_no_counterpart_is_refused(case: str) -> None:
    field, tables = REFUSED[case]
    scene = dry_scene({}, ONE, OTHER, end=0.1, step=0.01).to_dict() | tables
    with pytest.raises(CrosscheckError, match=field):
        crosscheck(scene_from_dict(scene))
