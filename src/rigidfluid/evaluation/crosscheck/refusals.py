"""Refusal of scenes that LAMMPS cannot run exactly as we do, with the reason."""

from __future__ import annotations

from rigidfluid.core.contact.restitution import Restitution
from rigidfluid.core.model.interactions import SumOfLaws
from rigidfluid.core.model.system import System
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import CrosscheckError
from rigidfluid.forces.spring_dashpot import SpringDashpotLaw


def refuse_foreign(scene: Scene, system: System) -> None:
    """Raise CrosscheckError if LAMMPS has no exact counterpart for something in the scene.

    Refused are a fluid, shapes other than balls, walls that slide or lie across no axis, motions that are prescribed,
    articulated bodies, joints, springs, held directions, several laws or one for some contacts alone, and laws that
    take energy out, but for ``spring-dashpot``.
    """
    if system.has_fluid:
        raise CrosscheckError(
            "fluid.backend", repr(scene.fluid.backend), "'dry'", "Leave the fluid out: --set fluid.backend=dry."
        )
    if scene.mechanism:
        found = f"{len(scene.mechanism)} of them"
        raise CrosscheckError("mechanism", found, "bodies that each move by themselves", "Leave mechanisms out.")
    if scene.joint:
        raise CrosscheckError("joint", f"{len(scene.joint)} of them", "bodies without joints", "Leave joints out.")
    for number, (table, body) in enumerate(zip(scene.body, system.bodies, strict=True)):
        field = f"body.{number}"
        if body.radius is None:
            raise CrosscheckError(
                f"{field}.type",
                repr(table.type),
                "balls: LAMMPS repels other shapes by laws of its own, which are none of these",
                "Use type = 'sphere'.",
            )
        if table.prescribed is not None:
            raise CrosscheckError(
                f"{field}.prescribed",
                "a prescribed motion",
                "free and fixed bodies",
                "Use fixed = true, or leave it out.",
            )
        for key in ("free", "spring"):
            if getattr(table, key) is not None:
                statement = "bodies that are held are not compared with LAMMPS"
                raise CrosscheckError(f"{field}.{key}", statement, None, f"Leave `{key}` out.")
        if table.part_of is not None:
            raise CrosscheckError(f"{field}.part_of", repr(table.part_of), "bodies of one part", "Leave part_of out.")
    for wall in system.walls:
        plane = wall.shape.plane
        if plane is None or plane.axis is None or wall.velocity is not None:
            found, allowed = f"the wall {wall.name!r}", "flat walls across an axis and at rest"
            raise CrosscheckError("domain", found, allowed, "Use domain.type = 'box', without velocities of walls.")
    law = system.law
    if isinstance(law, SumOfLaws):
        raise CrosscheckError(
            "interaction",
            f"{len(law.interactions)} interactions that act side by side or in some contacts alone",
            "one law for all contacts: pair styles of LAMMPS that add up are another sum",
            "Leave one of them, for all contacts.",
        )
    if isinstance(law, Restitution):
        allowed = "1: tables of LAMMPS hold no damper, and none of its contacts has this one"
        raise CrosscheckError("contact.restitution", law.restitution, allowed, "Leave it out.")
    if law is not None and (law.dissipative or not law.conservative) and not isinstance(law, SpringDashpotLaw):
        raise CrosscheckError(
            "contact.law",
            repr(law.name),
            "'spring-dashpot', and laws that keep the energy",
            "Choose another law; what LAMMPS lets films resist is another formula.",
        )
