"""Periodic surfaces of the domain, and their opposite ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.setup.boundary import boundary_table, table_key
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.model.interfaces import FluidBackend
    from rigidfluid.core.model.piece import Piece
    from rigidfluid.core.scene.scene import Scene

_APART = 1e-12
"""Opposite surfaces have the same corners but for this, over the size of the domain."""


def periodic_pairs(scene: Scene, domain: Domain) -> tuple[tuple[int, int], ...]:
    """Pairs of numbers of periodic pieces; one with a higher pressure than its opposite comes first.

    Raises SceneError for a surface without an opposite one that is periodic too, or with a higher pressure on both.
    """
    tables = [boundary_table(scene, name) for name in domain.names]
    chosen = [i for i, table in enumerate(tables) if table is not None and table.type == "periodic"]
    pairs = []
    for i in chosen:
        table = tables[i]
        assert table is not None
        at, name = table_key(scene, table), domain.names[i]
        others = [j for j in range(len(tables)) if _is_opposite(domain, domain.pieces[i], domain.pieces[j])]
        if not others:
            found = f"'periodic' on {name!r}, which has no equal surface opposite to it"
            raise SceneError(f"{at}.type", found, "it on a flat surface with such a one", "Choose another type.")
        if others[0] not in chosen:
            remedy = f"Set type = 'periodic' on {domain.names[others[0]]!r} too."
            raise SceneError(f"{at}.type", f"'periodic' on {name!r} alone", "it on the opposite surface too", remedy)
        other = tables[others[0]]
        assert other is not None
        if table.pressure_drop is not None and other.pressure_drop is not None:
            found = f"it on {name!r} and on {domain.names[others[0]]!r}"
            raise SceneError(f"{at}.pressure_drop", found, "it on one of two opposite surfaces", "Keep one.")
        if table.pressure_drop is not None or (other.pressure_drop is None and i < others[0]):
            pairs.append((i, others[0]))
    return tuple(pairs)


def check_periodic(scene: Scene, backend: type[FluidBackend], domain: Domain) -> None:
    """Refuse, with SceneError, periodic surfaces together with a backend, window, domain or condition that cannot take
    them."""
    if not domain.periodic:
        return
    table = boundary_table(scene, domain.names[domain.periodic[0][0]])
    assert table is not None
    at = f"{table_key(scene, table)}.type"
    if not backend.periodic_faces:
        found = f"'periodic' with backend {backend.name!r}"
        raise SceneError(at, found, "a backend that takes periodic surfaces", "Use backend = 'scikit-fem'.")
    if scene.domain.window is not None:
        raise SceneError(at, "'periodic' with a window", "one of both", "Remove [domain.window].")
    if domain.facets is not None:
        found = f"'periodic' in a domain of type {domain.name!r}, which is made of facets"
        raise SceneError(at, found, "a domain with a CAD shape, as 'box'", "Choose another type.")
    for piece in domain.pieces:
        other, plane = boundary_table(scene, piece.name), piece.shape.plane
        if other is not None and other.type in ("slip", "pressure") and (plane is None or plane.axis is None):
            found = f"'periodic' beside {other.type!r} on {piece.name!r}, which does not lie across an axis"
            raise SceneError(at, found, "'wall' there", "Make it a wall, or do without periodic surfaces.")


def _is_opposite(domain: Domain, piece: Piece, other: Piece) -> bool:
    """Whether two pieces are flat, face each other, and are equal but for a displacement across them."""
    one, two = piece.shape.plane, other.shape.plane
    if one is None or two is None or not np.allclose(one.unit_normal, -two.unit_normal, rtol=0, atol=_APART):
        return False
    way = float((two.point - one.point) @ one.unit_normal) * one.unit_normal
    apart = [np.abs(b - a - way) for a, b in zip(one.bounds, two.bounds, strict=True)]
    return bool(np.all(np.nan_to_num(apart, nan=np.inf) <= _APART * np.max(domain.size)))
