"""Refuses bodies that start in one another or outside the domain, and meshes that cannot resolve a gap."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.types import Contacts, Pose
from rigidfluid.core.scene.all_errors import raise_together
from rigidfluid.core.setup.shape_checks import check_shapes
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.model.body import Body
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.scene.mesh_tables import MeshTable
    from rigidfluid.core.setup.model import Model
    from rigidfluid.core.setup.placed_bodies import Arrangement


MOST_FACETS_PER_RADIUS = 10**4
"""Facets still smaller than that next to a body are a slip of units, and a mesher would never end."""


SMALLEST_BODY = 1e-8
"""Least bounding radius over the domain's largest coordinate [1]: smaller bodies are lost in rounding, and Netgen may
end the whole process."""


MOST_OVERLAPS_TOLD = 10
"""Pairs of surfaces whose overlap is told one by one: where a length is wrong, all bodies of a heap overlap."""


def check_geometry(model: Model, pose: Pose) -> None:
    """Refuse shapes that contradict themselves, with PluginError, and, with SceneError, bodies that overlap each other
    or a surface of the domain or are lost in it at their starting ``pose``, and a mesh too coarse for a gap."""
    check_shapes(model.shapes)
    mesh = model.fluid.mesh
    reach = _coarsest_gap(mesh, model.shapes) if mesh else 0.0
    contacts = check_places(model, pose, reach)
    if mesh is not None:
        _check_facets(mesh, model.shapes)
        _check_resolution(model, mesh, contacts)


def check_places(
    placed: Arrangement, pose: Pose, reach: float = 0.0, refusal: Callable[[int, int, float], SceneError] | None = None
) -> Contacts:
    """Contacts with gaps up to ``reach`` [length]; raises SceneError for bodies that overlap each other or a surface of
    the domain, or are lost in it: the ``refusal`` by both numbers and the depth, `overlap` if none is given."""
    _check_extent(placed)
    contacts = initial_contacts(placed, pose, reach)
    raise_together(list(_overlaps(contacts, refusal or partial(overlap, placed))))
    return contacts


def surfaces_of(domain: Domain, bodies: int) -> tuple[Wall, ...]:
    """Every piece of the boundary as a wall, whether it repels or not, in the order of surface numbers."""
    return tuple(Wall(bodies + i, piece.name, piece.shape) for i, piece in enumerate(domain.pieces))


def initial_contacts(placed: Arrangement, pose: Pose, reach: float) -> Contacts:
    """Contacts of all bodies with each other and with surfaces of the domain, those that do not repel among them, but
    with images instead of periodic surfaces that bodies cross, with gaps up to ``reach``, which may be infinite
    [length]."""
    bodies, walls = placed.shapes, surfaces_of(placed.domain, len(placed.shapes))
    make = partial(placed.exact_detector, placed.exact_detector.Options())
    if not (bodies and len(placed.crossed.vectors)):
        return make(bodies, walls).detect(pose, None, reach)
    from rigidfluid.core.contact.pairs.image_detection import ImageDetection

    solid = [wall for number, wall in enumerate(walls) if number not in placed.domain.periodic_pieces]
    return ImageDetection(make, bodies, solid, placed.crossed).detect(pose, reach)


def _check_extent(placed: Arrangement) -> None:
    _check_units(placed)
    farthest = float(np.max(np.abs(placed.domain.extent)))
    radius, smallest = min(((shape.bounding_radius, n) for n, shape in enumerate(placed.shapes)), default=(np.inf, 0))
    if radius < SMALLEST_BODY * farthest:
        raise SceneError(
            f"body.{smallest}",
            f"a bounding radius of {radius:.3g} in a domain that reaches {farthest:.3g}",
            f"at least {SMALLEST_BODY:g} of the domain's largest coordinate",
            "Make the domain smaller, or bring it nearer to the origin.",
        )


def _check_units(placed: Arrangement) -> None:
    """Refuse a body that cannot be in the domain wherever it is."""
    width = float(placed.domain.size.max())
    for number, shape in enumerate(placed.shapes):
        if shape.bounding_radius > width:
            found = f"a bounding radius of {shape.bounding_radius:.6g} in a domain of width {width:.6g}"
            remedy = "Use the same units for both; lengths in a file are multiplied by `domain.scale`."
            raise SceneError(f"body.{number}", found, "bodies smaller than the domain", remedy)


def _overlaps(contacts: Contacts, refusal: Callable[[int, int, float], SceneError]) -> Iterator[SceneError]:
    """An error for each pair of surfaces that overlap or touch, the deepest first; one for all that are too many."""
    deepest: dict[tuple[int, int], int] = {}
    for row in np.argsort(contacts.gap, kind="stable").tolist():
        if contacts.gap[row] <= 0.0:
            deepest.setdefault((int(contacts.body_a[row]), int(contacts.body_b[row])), row)
    rows = list(deepest.values())
    for row in rows[:MOST_OVERLAPS_TOLD]:
        yield refusal(int(contacts.body_a[row]), int(contacts.body_b[row]), abs(float(contacts.gap[row])))
    if more := rows[MOST_OVERLAPS_TOLD:]:
        yield SceneError(
            "further overlaps",
            f"{len(more)} more, by {abs(float(contacts.gap[more[0]])):.6g} at most",
            "bodies inside the domain and clear of all other surfaces",
            f"Mend the {MOST_OVERLAPS_TOLD} deepest, which are told one by one, and check again.",
        )


def overlap(placed: Arrangement, a: int, b: int, depth: float, remedy: str = "") -> SceneError:
    """Error of body number ``a``, which reaches so deep into the body or surface number ``b`` [length]; its remedy is
    to move it, if none is given."""
    body, kind = placed.all_bodies[a], "body" if b < len(placed.all_bodies) else "surface"
    other = f"{kind} {placed.surfaces[b]!r}" + (" of the domain" if kind == "surface" else "")
    where = f"overlaps {other} by {depth:.6g}" if depth > 0.0 else f"touches {other}"
    whole = {whole.name for whole in placed.mechanisms} & {body.part_of}
    return SceneError(
        f"mechanism {whole.pop()!r}" if whole else f"body.{a}.position",
        f"{list(body.position)}, where body {body.name!r} {where}",
        "a place inside the domain and clear of all other surfaces",
        remedy or f"Move it {f'by more than {depth:.6g}' if depth > 0.0 else 'away'}, or make it smaller.",
    )


def _check_facets(mesh: MeshTable, shapes: Sequence[Body]) -> None:
    largest = max((shape.bounding_radius for shape in shapes), default=0.0)
    least = largest / MOST_FACETS_PER_RADIUS
    if mesh.size_body < least:
        raise SceneError("mesh.size_body", mesh.size_body, f"at least {least:g} for these bodies", "Coarsen it.")


def _coarsest_gap(mesh: MeshTable, shapes: Sequence[Body]) -> float:
    """The largest gap that the mesh may be too coarse for [length]."""
    smallest = min((shape.bounding_radius for shape in shapes), default=np.inf)
    return float((mesh.size_body / 2**mesh.refinements) ** 2 / (4.0 * smallest))


def _check_resolution(model: Model, mesh: MeshTable, contacts: Contacts) -> None:
    """A chord h of a circle of radius R cuts off h²/(8R), which must stay below half the gap."""
    halvings = 2**mesh.refinements
    for k, gap in enumerate(contacts.gap):
        for surface in (int(contacts.body_a[k]), int(contacts.body_b[k])):
            if surface >= len(model.shapes):
                continue
            fine = halvings * sqrt(4 * model.shapes[surface].bounding_radius * float(gap))
            if mesh.size_body >= fine:
                a, b = (model.surfaces[int(s[k])] for s in (contacts.body_a, contacts.body_b))
                raise SceneError(
                    "mesh.size_body",
                    f"{mesh.size_body}, too coarse for the gap of {gap:.3g} between {a!r} and {b!r}",
                    f"less than {fine:.3g}",
                    f"Refine it, or allow more than {mesh.refinements} `refinements`.",
                )
