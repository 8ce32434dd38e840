"""Long-range forces of a model, each between two bodies that it names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from rigidfluid.core.joints.pair_spring import PairSpring
from rigidfluid.core.mechanics.shapes import inscribed_radius
from rigidfluid.core.model.pose_law import PoseLaw
from rigidfluid.core.model.selected import Selected
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.setup.checked import AnyRow, Positive, checked
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.model.body import Body
    from rigidfluid.core.setup.model import Model


@checked
class PairForce:
    """A long-range force between two bodies.

    Parameters
    ----------
    law : Selected
        Class of the law and its options.
    range : float
        Distance of the centres of mass above which it is zero [length].
    between : sequence of str
        Names of the two bodies.
    field : str, optional
        Key of the scene's table that asks for it, for messages; if not given, `pair_forces.0` and so on.
    """

    law: Selected[PoseLaw]
    range: Positive
    between: Annotated[tuple[str, ...], AnyRow, Field(min_length=2, max_length=2)]
    field: str | None = None

    def made(self, dimension: int) -> PoseLaw:
        """The law; raises SceneError if it refuses its options."""
        try:
            law = self.law.part(self.law.options, self.range)
            law.require_dimension(dimension)
        except SceneError as error:  # a law does not know its table
            subject = f"{self.field}.{error.subject.removeprefix('contact.')}"
            raise SceneError(subject, error.found, error.allowed, error.remedy) from None
        return law


def told_in_order(forces: Sequence[PairForce]) -> tuple[PairForce, ...]:
    """The forces, each with its field."""
    return tuple(replace(one, field=one.field or f"pair_forces.{number}") for number, one in enumerate(forces))


def pair_springs(model: Model) -> list[PairSpring]:
    """Springs of the model's long-range forces; raises SceneError for one without a least distance."""
    names, springs = [body.name for body in model.all_bodies], []
    for force in told_in_order(model.pair_forces):
        first, second = map(names.index, force.between)
        closest = sum(_depth(model.all_bodies[number].shape, force) for number in (first, second))
        springs.append(PairSpring(force.made(model.dimension), first, second, closest))
    return springs


def check_pair_forces(model: Model) -> None:
    """Refuse, with SceneError, long-range forces of unknown bodies or of one with itself, and options that do not
    fit."""
    names = [body.name for body in model.all_bodies]
    for force in told_in_order(model.pair_forces):
        for number, name in enumerate(force.between):
            if name not in names:
                known = ", ".join(names[:20]) + (", …" if len(names) > 20 else "")
                remedy = suggestion(name, names) or "Name a body: walls have no pose."
                raise SceneError(f"{force.field}.names.{number}", f"{name!r}, no body", f"one of {known}", remedy)
        if len(set(force.between)) == 1:
            raise SceneError(f"{force.field}.names", list(force.between), "two different bodies", "Correct the names.")
        force.made(model.dimension)


def _depth(shape: Body, force: PairForce) -> float:
    """Distance of a body's surface from its centre of mass, which no other body passes [length]."""
    depth = inscribed_radius(shape)
    if depth == 0.0:
        found = "a body whose centre of mass is outside of it"
        remedy = "Choose another body: others may come as near to that point as they will."
        raise SceneError(f"{force.field}.names", found, "bodies around their centres of mass", remedy)
    return depth
