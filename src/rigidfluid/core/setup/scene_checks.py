"""Refuses scenes whose keys are valid one by one but not together: doubled names, contradictions."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from rigidfluid.core.nested.placing import check_orientation
from rigidfluid.core.setup.body_force import check_body_force
from rigidfluid.core.setup.boundary_checks import check_inflow, check_oblique
from rigidfluid.core.setup.initial_flow import check_initial_flow
from rigidfluid.core.setup.mesh_checks import check_cells, check_mesh_table
from rigidfluid.core.setup.periodic import check_periodic
from rigidfluid.errors import SceneError
from rigidfluid.registry import suggestion

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import BodyTable, Scene
    from rigidfluid.core.setup.parts import Parts

MOST_STEPS = 10**9
"""A scene of more nominal steps than this is a slip of units."""


def check_tables(scene: Scene) -> None:
    """Refuse, with SceneError, tables that contradict themselves or each other."""
    if not (scene.body or scene.mechanism):
        raise SceneError("body", "nothing", "a body or a mechanism", "Add a table [[body]] or [[mechanism]].")
    for number, mechanism in enumerate(scene.mechanism):
        check_orientation(mechanism, scene.dimension, f"mechanism.{number}")
    for number, body in enumerate(scene.body):
        check_orientation(body, scene.dimension, f"body.{number}")
        _check_control(body, f"body.{number}")
    _check_assemblies(scene)
    _check_contact(scene)
    _check_times(scene)
    check_mesh_table(scene)


def check_fluid(parts: Parts) -> None:
    """Refuse, with SceneError, a scene that lacks the density, viscosity or mesh that its backend needs, has a
    tolerance for a backend without a mesh, or prescribes an impossible flow."""
    scene, backend, domain = parts.scene, parts.backend.part, parts.domain
    check_initial_flow(scene, backend, domain)
    check_body_force(parts)
    check_periodic(scene, backend, domain)
    if not parts.wet:
        if scene.time.tolerance is not None:
            allowed = f"none with backend {backend.name!r}, whose bodies go through contacts in substeps of their own"
            raise SceneError("time.tolerance", scene.time.tolerance, allowed, "Remove it.")
        return
    beside = f"with backend {backend.name!r}"
    for key in ("density", "viscosity"):
        if getattr(scene.fluid, key) is None:
            raise SceneError(f"fluid.{key}", "nothing", f"a number above 0 {beside}", f"Add {key!r}.")
    if scene.mesh is None:
        raise SceneError("mesh", "nothing", f"a table {beside}", "Add [mesh] with size and size_body.")
    check_cells(scene.mesh, domain)
    check_oblique(scene, backend, domain)
    check_inflow(scene, domain)


def _check_control(body: BodyTable, at: str) -> None:
    """A body moves freely, is fixed, or follows a prescription: one of them."""
    given = [key for key in ("velocity", "angular_velocity") if getattr(body, key) is not None]
    if body.fixed and (given or body.prescribed):
        other = given[0] if given else "prescribed"
        raise SceneError(f"{at}.fixed", f"true beside {other!r}", "one of them", f"Remove `fixed` or {other!r}.")
    if body.prescribed and given:
        where = f"`{at}.prescribed`"
        statement = "a body with `prescribed` has its velocities there"
        raise SceneError(f"{at}.{given[0]}", statement, None, f"Move it into {where}.")
    if body.prescribed and (body.prescribed.amplitude is None) != (body.prescribed.frequency is None):
        missing = "amplitude" if body.prescribed.amplitude is None else "frequency"
        field = f"{at}.prescribed.{missing}"
        raise SceneError(field, "nothing", "amplitude and frequency together, or neither", f"Add {missing!r}.")


def _check_assemblies(scene: Scene) -> None:
    """A name that only one body gives is a slip of the pen."""
    wholes = [body.part_of for body in scene.body]
    for number, whole in enumerate(wholes):
        if whole is not None and wholes.count(whole) == 1:
            others = sorted({name for name in wholes if name is not None and name != whole})
            remedy = suggestion(whole, others) or "Give it to the other parts too, or remove it."
            raise SceneError(f"body.{number}.part_of", repr(whole), "a name that at least two bodies give", remedy)


def _check_contact(scene: Scene) -> None:
    law, range_ = scene.contact.law, scene.contact.range
    if law is not None and range_ is None:
        raise SceneError("contact.range", "nothing", "a length above 0 beside `law`", "Add the law's reach.")
    if law is None and range_ is not None:
        raise SceneError("contact.range", f"{range_} without a law", "`range` beside `law`", "Name the law: `law = …`.")
    own = dict.fromkeys(("smallest_gap", "restitution", "restitution_stokes"), law)
    for key, read in {**own, "impact_speed": law or scene.interaction}.items():
        given = getattr(scene.contact, key)
        if not read and given is not None:
            remedy = "Name the law: `law = …`."
            raise SceneError(f"contact.{key}", f"{given} without a law", f"`{key}` beside `law`", remedy)
    if scene.contact.stepping == "implicit" and scene.contact.substeps is not None:
        allowed = 'none beside `stepping = "implicit"`'
        raise SceneError("contact.substeps", scene.contact.substeps, allowed, "Remove one of them.")


def _check_times(scene: Scene) -> None:
    time = scene.time
    if time.step > time.end:
        raise SceneError("time.step", time.step, f"at most time.end = {time.end}", "Shorten it, or end later.")
    if time.end / time.step > MOST_STEPS:
        raise SceneError("time.step", time.step, f"at least {time.end / MOST_STEPS:g} for this end", "Lengthen it.")
    if scene.output.every < time.step:
        raise SceneError("output.every", scene.output.every, f"at least time.step = {time.step}", "Write less often.")
    if time.shortest > time.step:
        raise SceneError("time.shortest", time.shortest, f"at most time.step = {time.step}", "Shorten it.")
    for body in scene.body:
        _check_frequency(body, time.step)


def _check_frequency(body: BodyTable, step: float) -> None:
    """Longer steps could go more than all of the way to and fro, and not meet it."""
    frequency = abs(body.prescribed.frequency or 0.0) if body.prescribed else 0.0
    if pi * frequency * step > 1.0:
        found = f"{step:g}, {frequency * step:.3g} periods of body {body.name!r}"
        raise SceneError("time.step", found, f"at most {1.0 / (pi * frequency):.3g}", "Shorten it.")
