"""The scalar that a scene's fluid carries along."""

from __future__ import annotations

from collections.abc import Sequence

from rigidfluid.core.model.domain import Domain
from rigidfluid.core.nested.expressions import Expression
from rigidfluid.core.scene.all_errors import raise_all
from rigidfluid.core.scene.scalar_table import ScalarBodyTable, ScalarBoundaryTable, ScalarTable
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.setup.scalar import Scalar, ScalarOnSurface
from rigidfluid.errors import SceneError

_EVERYWHERE = "all"


def scene_scalar(table: ScalarTable, domain: Domain, bodies: Sequence[str]) -> Scalar:
    """The scalar of a table, in a domain and on these ``bodies``; ``all`` are not periodic surfaces.

    Raises SceneError for a name that is none of theirs, and for invalid expressions.
    """
    dimension, seams = domain.dimension, domain.periodic_pieces
    names = [name for piece in domain.pieces for name in piece.all_names]
    raise_all(_wrong_names(table.boundary, "boundary", names))
    raise_all(_wrong_names(table.body, "body", bodies))
    if table.reference is not None and table.expansion is None:
        raise SceneError("scalar.reference", table.reference, "one with scalar.expansion", "Add it, or leave both out.")
    on_faces = {
        piece.name: _on_surface(*named, dimension)
        for number, piece in enumerate(domain.pieces)
        for named in _last(table.boundary, "boundary", (*piece.all_names, *([] if number in seams else [_EVERYWHERE])))
    }
    on_bodies = {
        name: _on_surface(*named, dimension)
        for name in bodies
        for named in _last(table.body, "body", (name, _EVERYWHERE))
    }
    return Scalar(
        diffusivity=table.diffusivity,
        initial=Expression(table.initial, "scalar.initial", dimension),
        source=None if table.source is None else Expression(table.source, "scalar.source", dimension),
        expansion=table.expansion,
        reference=table.reference or 0.0,
        on_faces=on_faces,
        on_bodies=on_bodies,
    )


_Table = ScalarBoundaryTable | ScalarBodyTable


def _last(tables: Sequence[_Table], key: str, names: Sequence[str]) -> list[tuple[_Table, str]]:
    """The last of the ``tables`` that is on one of the ``names``, if any, with its place in the scene."""
    found = [(table, f"scalar.{key}.{number}") for number, table in enumerate(tables) if table.on in names]
    return found[-1:]


def _on_surface(table: _Table, at: str, dimension: int) -> ScalarOnSurface:
    value, flux = (
        None if given is None else Expression(given, f"{at}.{key}", dimension, f" on {table.on!r}")
        for key, given in (("value", table.value), ("flux", table.flux))
    )
    own = (table.capacity, table.conductivity) if isinstance(table, ScalarBodyTable) else (None, None)
    return ScalarOnSurface(value, flux, *own, at)


def _wrong_names(tables: Sequence[_Table], key: str, known: Sequence[str]) -> list[SceneError]:
    found = [(f"scalar.{key}.{n}.on", one.on) for n, one in enumerate(tables) if one.on not in (_EVERYWHERE, *known)]
    allowed = ", ".join((_EVERYWHERE, *known))
    return [SceneError(at, repr(on), allowed, suggestion(on, known) or "Correct the name.") for at, on in found]
