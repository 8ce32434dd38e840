"""Laws of a model, each with the contacts that it acts in, and the interactions that are made of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from rigidfluid.core.contact.laws.film_loss import FilmLoss
from rigidfluid.core.contact.laws.friction import Friction, Rubbing
from rigidfluid.core.contact.laws.restitution import Restitution
from rigidfluid.core.contact.laws.rough_film import RoughFilm
from rigidfluid.core.geometry.piece import Piece, all_names
from rigidfluid.core.mechanics.coulomb import TurningFriction
from rigidfluid.core.model.force_law import Between, ForceLaw
from rigidfluid.core.model.interactions import Interaction, acting_together
from rigidfluid.core.model.selected import Selected
from rigidfluid.core.model.types import Loads
from rigidfluid.core.scene.numbered_names import ANY, stands_for
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.setup.checked import AnyRow, Positive, checked
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.setup.model import Model

SMALLEST_GAP = 0.25
"""The smallest gap wanted over the range of the law, if none is given."""

MAY_BE_OWN = (
    *("restitution", "friction", "tangential_stiffness", "tangential_damping"),
    *("rolling_friction", "twisting_friction"),
)
"""Keys that every law may have, and that some have as options of their own."""


@checked
class ContactLaw:
    """A law of contact, and the contacts that it acts in; forces of several add up.

    Parameters
    ----------
    law : Selected
        Class of the law and its options; it is made once the loads of contacts are known.
    range : float
        Gap above which it is zero [length].
    smallest_gap : float, optional
        Gap at which the expected impact is to end; range/4 if not given [length].
    restitution : float, optional
        Speed after over speed before a dry head-on impact; 1 if not given [1].
    restitution_stokes : float, optional
        β, with which an impact ends with ``restitution`` · exp(-β/St) of its speed, St its Stokes number [1].
    roughness : float, optional
        Gap at which the film ends and surfaces touch, at most the smallest gap, in place of β [length].
    friction : float, optional
        Coefficient μ of static and sliding friction; none if not given [1].
    tangential_stiffness : float, optional
        Stiffness of springs along the surfaces; 2/7 of the law's at the smallest gap if not given [force/length].
    tangential_damping : float, optional
        Ratio of the dashpots' coefficient along the surfaces to the one by the restitution; 1 if not given [1].
    rolling_friction : float, optional
        Coefficient of friction that resists rolling, of balls; none if not given [1].
    twisting_friction : float, optional
        Coefficient of friction that resists turning about the normal, of balls; none if not given [1].
    between : str
        Contacts at `walls`, of `pairs` of bodies, or `all`.
    names : sequence of str
        Bodies or walls, by either name of a wall: all contacts of one, or that of two with each other; any contacts if
        empty. `grain*` is any of `grain0`, `grain1` and so on, whether it is there or has yet to enter.
    field : str, optional
        Key of the scene's table that asks for it, for messages; if not given, `contact` of a law alone, and of several
        `interaction.0` and so on.
    """

    law: Selected[ForceLaw]
    range: Positive
    smallest_gap: Positive | None = None
    restitution: Annotated[Positive, Field(le=1)] | None = None
    restitution_stokes: Positive | None = None
    roughness: Positive | None = None
    friction: Annotated[float, Field(ge=0)] | None = None
    tangential_stiffness: Positive | None = None
    tangential_damping: Annotated[float, Field(ge=0)] | None = None
    rolling_friction: Annotated[float, Field(ge=0)] | None = None
    twisting_friction: Annotated[float, Field(ge=0)] | None = None
    between: Between = "all"
    names: Annotated[tuple[str, ...], AnyRow, Field(max_length=2)] = ()
    field: str | None = None

    @property
    def aim(self) -> float:
        """Gap at which the expected impact is to end [length]."""
        return self.smallest_gap or SMALLEST_GAP * self.range

    @property
    def acts_in(self) -> Between:
        """Contacts that the table asks for, or of all those that the law is made for."""
        return self.law.part.acts_in if self.between == "all" else self.between

    def interaction(self, surfaces: Sequence[str], loads: Loads) -> Interaction:
        """The law made for ``loads``, with the contacts that it acts in; ``surfaces`` are the names of bodies and then
        of the domain's pieces. Raises SceneError if the law refuses its options or loads."""
        assert self.field is not None
        return Interaction(
            field=self.field,
            law=self._made(replace(loads, smallest_gap=self.aim)),
            between=self.acts_in,
            surfaces=tuple(
                tuple(number for number, name in enumerate(surfaces) if stands_for(named, name)) for named in self.names
            ),
            smallest_gap=self.smallest_gap,
        )

    def _made(self, loads: Loads) -> ForceLaw:
        part, options = self.law.part, self.law.options
        try:
            law = part(options, self.range, loads)
            loss, own = self._film_loss(loads), is_own("restitution", part)
            if loss is not None or not (self.restitution in (None, 1.0) or own):
                law = Restitution(law, self.restitution or 1.0, loss)
            rubbing = self._rubbing()
            return law if rubbing is None else Friction(law, rubbing)
        except SceneError as error:  # a law does not know its table
            subject = f"{self.field}.{error.subject.removeprefix('contact.')}"
            allowed = (error.allowed or "").replace("contact.range", f"{self.field}.range") or None
            raise SceneError(subject, error.found, allowed, error.remedy) from None

    def _rubbing(self) -> Rubbing | None:
        """Numbers of friction that is not the law's own; None without any."""
        part = self.law.part
        keys = {key: getattr(self, key) for key in MAY_BE_OWN[1:] if not is_own(key, part)}
        along = [key for key in keys if key != "friction" and keys[key] is not None]
        if is_own("friction", part) and along:
            allowed = f"a law whose friction is not its own, as it is with {part.name!r}"
            raise SceneError(f"{self.field}.{along[0]}", keys[along[0]], allowed, "Remove it, or choose another law.")
        if keys.get("friction"):
            damping = 1.0 if self.tangential_damping is None else self.tangential_damping
            turning = TurningFriction(self.rolling_friction or 0.0, self.twisting_friction or 0.0)
            return Rubbing(keys["friction"], self.tangential_stiffness, damping, self.aim, turning)
        if along:
            remedy = "Remove it, or add `friction`."
            raise SceneError(f"{self.field}.{along[0]}", keys[along[0]], "`friction` above 0 beside it", remedy)
        return None

    def _film_loss(self, loads: Loads) -> FilmLoss | RoughFilm | None:
        """Loss of impacts that the film takes a part in; None if they are dry."""
        given = {key: getattr(self, key) for key in ("restitution_stokes", "roughness")}
        wanted = [key for key, value in given.items() if value is not None]
        if not wanted:
            return None
        first = f"{self.field}.{wanted[-1]}", given[wanted[-1]]
        if len(wanted) == 2:
            allowed = f"one of both, as {self.field}.restitution_stokes is the film's whole loss too"
            raise SceneError(*first, allowed, "Remove either.")
        if is_own("restitution", self.law.part):
            allowed = f"a law whose restitution is not its own, as it is with {self.law.part.name!r}"
            raise SceneError(*first, allowed, "Remove it, or choose another law.")
        if loads.film is None:
            allowed = "a fluid with a viscosity, which the Stokes number of an impact is made of"
            raise SceneError(*first, allowed, "Remove it, or choose a backend with a fluid.")
        if self.restitution_stokes is not None:
            return FilmLoss(self.restitution_stokes, loads.film, loads)
        assert self.roughness is not None
        return RoughFilm(self.roughness, loads.film, loads)


def interactions_of(laws: Sequence[ContactLaw], surfaces: Sequence[str], loads: Loads) -> tuple[Interaction, ...]:
    """The laws made for ``loads``, those that attract first: the others hold what these pull together."""
    attracting = {law.field: law.interaction(surfaces, loads) for law in laws if law.law.part.sign == "attracts"}
    if attracting:
        loads = replace(loads, attraction=acting_together(tuple(attracting.values())))
    return tuple(attracting.get(law.field) or law.interaction(surfaces, loads) for law in laws)


def told_apart(laws: Sequence[ContactLaw], pieces: Iterable[Piece]) -> tuple[ContactLaw, ...]:
    """The laws of a model, each with its field, and with names of ``pieces`` in the place of other names of these."""
    fields = ["contact"] if len(laws) == 1 else [f"interaction.{number}" for number in range(len(laws))]
    own = {name: piece.name for piece in pieces for name in piece.all_names}
    return tuple(
        replace(law, field=law.field or field, names=tuple(own.get(name, name) for name in law.names))
        for law, field in zip(laws, fields, strict=True)
    )


def is_own(key: str, law: type[ForceLaw]) -> bool:
    """Tell whether a ``key`` of MAY_BE_OWN is an option of the law itself."""
    return key in law.Options.model_fields


def check_laws(model: Model) -> None:
    """Refuse, with SceneError, laws that act nowhere or cannot act there, whose smallest gap is not below their range,
    or whose roughness is above that gap."""
    for law in model.named_laws:
        if law.smallest_gap is not None and law.smallest_gap >= law.range:
            allowed = f"a length above 0 and below {law.field}.range = {law.range}"
            raise SceneError(f"{law.field}.smallest_gap", law.smallest_gap, allowed, "Shorten it, or widen the range.")
        if law.roughness is not None and law.roughness > law.aim:
            allowed = f"a length up to the smallest gap, {law.aim:g}, a part of {law.field}.range = {law.range}"
            raise SceneError(f"{law.field}.roughness", law.roughness, allowed, "Shorten it, or widen the range.")
        _check_names(model, law)
        _check_shapes(model, law)


def _check_names(model: Model, law: ContactLaw) -> None:
    bodies, walls = [body.name for body in model.all_bodies], [wall.name for wall in model.walls]
    for number, name in enumerate(law.names):
        if name not in (*bodies, *walls) and not name.endswith(ANY):
            raise _unknown(model, f"{law.field}.names.{number}", name)
    at_walls = any(name in walls for name in law.names)
    pair = len(law.names) == 2
    made_for = law.law.part.acts_in
    if made_for not in ("all", law.acts_in):
        allowed = f"{made_for}, where {law.law.part.name!r} acts"
        raise SceneError(f"{law.field}.between", law.between, allowed, "Correct it, or choose another law.")
    if pair and ((len(set(law.names)) == 1 and law.names[0] in bodies) or all(name in walls for name in law.names)):
        raise _nowhere(law, "two different surfaces, one of them a body")
    if (at_walls and law.acts_in == "pairs") or (pair and not at_walls and law.acts_in == "walls"):
        raise _nowhere(law, f"surfaces that meet with between = {law.acts_in!r}")
    wholes = [model.all_bodies[bodies.index(name)].part_of for name in law.names if name in bodies]
    if pair and len(wholes) == 2 and wholes[0] is not None and wholes[0] == wholes[1]:
        raise _nowhere(law, "bodies that are not parts of one articulated body, which do not touch")


def _check_shapes(model: Model, law: ContactLaw) -> None:
    """Refuse a law that does not know the shapes of the bodies it acts on."""
    named = [body.shape for body in model.all_bodies if any(stands_for(name, body.name) for name in law.names)]
    shapes, part = named if len(law.names) == 2 else model.shapes, law.law.part
    if part.balls_only and any(shape.radius is None for shape in shapes):
        remedy = "Choose another law; `rigidfluid plugins` lists what is installed."
        found = f"{part.name!r} with bodies that are no balls"
        raise SceneError(f"{law.field}.law", found, "a law for any shape", remedy)
    if part.film and any(shape.semi_axes is None for shape in shapes):
        remedy = "Keep it to other contacts by `between` or `names`, or choose another law."
        found = f"{part.name!r} with bodies of unknown curvature"
        raise SceneError(f"{law.field}.law", found, "balls, ellipses and ellipsoids", remedy)


def _unknown(model: Model, field: str, name: str) -> SceneError:
    open_face = "a surface that is no wall, and does not repel" if name in model.domain.names else "no surface"
    bodies, repelling = [body.name for body in model.all_bodies], {wall.name for wall in model.walls}
    walls = [piece for piece in model.domain.pieces if piece.name in repelling]
    known = [*(piece.names_in_words for piece in walls), *bodies]
    shown = ", ".join(known[:20]) + (", …" if len(known) > 20 else "")
    remedy = suggestion(name, [*bodies, *all_names(walls)]) or "Name a body or a wall."
    return SceneError(field, f"{name!r}, {open_face}", f"one of {shown}", remedy)


def _nowhere(law: ContactLaw, allowed: str) -> SceneError:
    return SceneError(f"{law.field}.names", list(law.names), allowed, "Correct the names, or `between`.")
