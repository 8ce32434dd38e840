"""Refusal of scenes that LAMMPS cannot run exactly as rigidfluid does, with the reason."""

from __future__ import annotations

from rigidfluid.api import Scene, SpringDashpotLaw, System
from rigidfluid_lammps.errors import CrosscheckError


def refuse_foreign(scene: Scene, system: System) -> None:
    """Raise CrosscheckError if LAMMPS has no exact counterpart for something in the scene.

    Refused are a fluid, shapes other than balls, walls that slide or lie across no axis, motions that are prescribed,
    articulated bodies, bodies that enter or leave, joints, springs, held directions, long-range forces, several laws or
    one for some contacts alone, and laws that take energy out, but for ``spring-dashpot``.
    """
    if system.has_fluid:
        raise CrosscheckError(
            "fluid.backend", repr(scene.fluid.backend), "'dry'", "Leave the fluid out: --set fluid.backend=dry."
        )
    _refuse_linked_bodies(scene)
    for number in range(len(scene.body)):
        _refuse_body(scene, system, number)
    _refuse_walls(system)
    if system.joints.linked.any():
        found, allowed = "a long-range force between two bodies", "laws of contact"
        raise CrosscheckError("interaction", found, allowed, "Leave it out.")
    _refuse_law(scene, system)


def _refuse_linked_bodies(scene: Scene) -> None:
    if scene.mechanism:
        found = f"{len(scene.mechanism)} of them"
        raise CrosscheckError("mechanism", found, "bodies that each move by themselves", "Leave mechanisms out.")
    if scene.joint:
        raise CrosscheckError("joint", f"{len(scene.joint)} of them", "bodies without joints", "Leave joints out.")
    for key, tables in {"source": scene.source, "sink": scene.sink}.items():
        if tables:
            found, allowed = "bodies that enter or leave", "the same bodies at all times"
            raise CrosscheckError(key, found, allowed, "Leave it out.")


def _refuse_body(scene: Scene, system: System, number: int) -> None:
    table, field = scene.body[number], f"body.{number}"
    if system.bodies[number].radius is None:
        raise CrosscheckError(
            f"{field}.type",
            repr(table.type),
            "balls: LAMMPS repels other shapes by laws of its own, which are none of these",
            "Use type = 'sphere'.",
        )
    if table.prescribed is not None:
        remedy = "Use fixed = true, or leave it out."
        raise CrosscheckError(f"{field}.prescribed", "a prescribed motion", "free and fixed bodies", remedy)
    for key in ("free", "spring"):
        if getattr(table, key) is not None:
            statement = "bodies that are held are not compared with LAMMPS"
            raise CrosscheckError(f"{field}.{key}", statement, None, f"Leave `{key}` out.")
    if table.part_of is not None:
        raise CrosscheckError(f"{field}.part_of", repr(table.part_of), "bodies of one part", "Leave part_of out.")


def _refuse_walls(system: System) -> None:
    for wall in system.walls:
        plane = wall.shape.plane
        if plane is None or plane.axis is None or wall.velocity is not None:
            found, allowed = f"the wall {wall.name!r}", "flat walls across an axis and at rest"
            raise CrosscheckError("domain", found, allowed, "Use domain.type = 'box', without velocities of walls.")


def _refuse_law(scene: Scene, system: System) -> None:
    law = system.law
    if isinstance(law, SpringDashpotLaw):
        _refuse_friction(law, system.interactions[0].field)
    if law is None or isinstance(law, SpringDashpotLaw):
        return
    if all(law is not interaction.law for interaction in system.interactions):
        raise CrosscheckError(
            "interaction",
            f"{len(system.interactions)} interactions that act side by side or in some contacts alone",
            "one law for all contacts: pair styles of LAMMPS that add up are another sum",
            "Leave one of them, for all contacts.",
        )
    if law.conservative and not law.dissipative:
        return
    field = system.interactions[0].field
    table = scene.contact if field == "contact" else scene.interaction[0]
    if table.restitution is not None:
        allowed = "1: tables of LAMMPS hold no damper, and none of its contacts has this one"
        raise CrosscheckError(f"{field}.restitution", table.restitution, allowed, "Leave it out.")
    if table.friction:
        allowed = "0: tables of LAMMPS have no friction; its law 'spring-dashpot' has"
        raise CrosscheckError(f"{field}.friction", table.friction, allowed, "Leave it out, or choose that law.")
    raise CrosscheckError(
        f"{field}.law",
        repr(law.name),
        "'spring-dashpot', and laws that keep the energy",
        "Choose another law; what LAMMPS lets films resist is another formula.",
    )


def _refuse_friction(law: SpringDashpotLaw, field: str) -> None:
    options = law.options
    if law.rolling:
        allowed = "friction of sliding alone: LAMMPS' couples act at the radii of the enlarged balls"
        subject = f"{field}.{law.round_option}"
        raise CrosscheckError(subject, "friction of rolling or twisting", allowed, "Leave it out.")
    damped = options.damping if options.restitution is None else options.restitution < 1.0
    if law.sticking and options.bounded_dashpot and damped and options.tangential_damping > 0.0:
        allowed = "false: beside a spring along the surfaces LAMMPS limits the sum with the dashpot alone"
        remedy = "Set it to false, or tangential_damping to 0."
        raise CrosscheckError(f"{field}.bounded_dashpot", "true", allowed, remedy)
