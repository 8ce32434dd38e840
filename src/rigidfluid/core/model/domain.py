"""The region that fluid and bodies share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection
from copy import copy
from typing import Any, ClassVar, Self

import numpy as np

from rigidfluid.core.geometry.answers import anything, instance, number, optional, several
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.guarded import gives
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.model import part_answers as parts
from rigidfluid.core.model.part import SpatialPart


class Domain(SpatialPart):
    """A bounded region, its boundary made of named pieces.

    Surfaces are numbered through, the n bodies first: piece i is surface n + i. Nodes of the mesh slide along flat
    pieces across an axis, and are held on all others. When the mesh is regenerated, nodes of flat pieces are put back
    into all their planes; the facets of other pieces are kept as those of bodies are, or halved with the new node on
    the closest point of the piece.

    Parameters
    ----------
    options : PartOptions
        The type's own keys of the ``[domain]`` table.
    dimension : int
        2 or 3.
    """

    kind: ClassVar[str] = "domain"
    periodic: tuple[tuple[int, int], ...] = ()
    """Pairs of flat pieces, by their numbers, that are periodic: what leaves by one comes in by the other.
    The second is the first displaced. A mesh may be cut open elsewhere, so that their facets are not on the pieces."""

    @property
    @abstractmethod
    @gives(parts.pieces)
    def pieces(self) -> tuple[Piece, ...]:
        """The pieces of the boundary, each with a name of its own, in the order of their surface numbers."""

    @property
    @abstractmethod
    @gives(parts.extent)
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper corner of the box around the domain, (d,) each [length]."""

    @property
    @abstractmethod
    @gives(number(0.0))
    def volume(self) -> float:
        """Exact volume (area in 2D), without bodies [length^d]."""

    @abstractmethod
    @gives(parts.truths)
    def contains(self, points: FloatArray) -> BoolArray:
        """Tell whether each of ``points`` (N, d) is inside, (N,); on the boundary either may be said."""

    @gives(anything)
    def cad_shape(self, unit: float) -> Any:
        """The domain as a ``netgen.occ`` face (2D) or solid (3D), all its lengths over ``unit``, whose edges (2D) or
        faces (3D) have the names of the pieces that they lie on; None of one made of `facets`."""
        return None

    @property
    @gives(optional(parts.facets))
    def facets(self) -> Facets | None:
        """The facets that the boundary is made of, marked by the number of their piece; None where there is a
        `cad_shape`."""
        return None

    @property
    def periodic_pieces(self) -> frozenset[int]:
        """Numbers of the pieces that are periodic."""
        return frozenset(number for pair in self.periodic for number in pair)

    def with_periodic(self, pairs: tuple[tuple[int, int], ...]) -> Self:
        """The same domain with these ``pairs`` of periodic pieces."""
        other = copy(self)
        other.periodic = pairs
        return other

    @property
    def lattice(self) -> FloatArray:
        """Displacements from the first to the second piece of each periodic pair, (k, d) [length]."""
        planes = [[self.pieces[number].shape.plane for number in pair] for pair in self.periodic]
        ways = [
            float((two.point - one.point) @ one.unit_normal) * one.unit_normal for one, two in planes if one and two
        ]
        return np.array(ways, dtype=float).reshape(-1, self.dimension)

    def wrapped(self, points: FloatArray) -> FloatArray:
        """Images of ``points`` (N, d) between the periodic surfaces, (N, d) [length]: bodies leave by one and go on.

        They are the points themselves where no surface is periodic.
        """
        return self.cells.wrapped(points)

    @property
    def cells(self) -> Lattice:
        """The lattice that the periodic surfaces make, with the domain in its first cell."""
        vectors = self.lattice
        forward = np.where(vectors.sum(axis=1) < 0.0, -1.0, 1.0)
        return Lattice(forward[:, None] * vectors, self.extent[0])

    @property
    def alone(self) -> Lattice:
        """The lattice without vectors: bodies stay in the domain."""
        return Lattice(self.cells.vectors[:0], self.extent[0])

    def called(self, names: Collection[str]) -> Self:
        """The same domain, each of its pieces under its other name where that is among the ``names``."""
        return self

    @gives(optional(instance(lambda: Domain)))
    def between(self, axis: int, lower: float, upper: float) -> Domain | None:
        """The part with ``lower`` ≤ x ≤ ``upper`` along an ``axis`` [length], with pieces of the same names in the same
        order, two of them flat across the axis; None of a domain that is not the same all along it."""
        return None

    @property
    @gives(several(lambda: str))
    def remarks(self) -> tuple[str, ...]:
        """Remarks for a user on how it was read or made; each is a sentence without its full stop."""
        return ()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the pieces, in the order of their surface numbers."""
        return tuple(piece.name for piece in self.pieces)

    @property
    def names_in_words(self) -> str:
        """The names of the pieces, with the other names that they have, for a message."""
        return ", ".join(piece.names_in_words for piece in self.pieces)

    @property
    def size(self) -> FloatArray:
        """Lengths of the sides of the box around the domain, (d,) [length]."""
        lower, upper = self.extent
        return np.asarray(upper - lower)
