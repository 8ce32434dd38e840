"""A plane channel that two round bumps narrow to a throat."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.mesher_unit import in_unit
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.model.part import PartOptions
from rigidfluid.domains.arc import Arc
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.domains.in_box import InBox
from rigidfluid.errors import SceneError


class StenosisOptions(PartOptions):
    """Keys of the ``[domain]`` table with type ``stenosis``: a channel along x with the middle of its throat at the
    origin.

    Its surfaces are ``left`` and ``right``, the walls ``bottom`` and ``top``, and on these ``bottom_bump`` and
    ``top_bump``, each the part of a disk of the given radius that protrudes from the wall. Without ``throat`` the bumps
    are half disks with centres on the walls; a wider throat makes them flatter, a narrower one rounder.
    """

    length: float = Field(gt=0, description="Length of the channel, along x [length]")
    width: float = Field(gt=0, description="Width of the channel, along y [length]")
    radius: float = Field(gt=0, description="Radius of the bumps [length]")
    throat: float | None = Field(
        default=None, gt=0, description="Width between the bumps; width - 2 radius if not given [length]"
    )


class Stenosis(InBox):
    """A rectangle without two circular segments, which leave a throat of the given width.

    Raises SceneError in 3D, and if the bumps would not hold together, touch each other, or be longer than the channel.
    """

    name: ClassVar[str] = "stenosis"
    Options: ClassVar[type[PartOptions]] = StenosisOptions
    options: StenosisOptions

    def __init__(self, options: StenosisOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        if dimension != 2:
            remedy = "Take a tube from a file: type = 'cad'."
            raise SceneError("domain.type", "'stenosis' in 3D", "2 dimensions", remedy)
        half = 0.5 * np.array([options.length, options.width])
        self._box = Box(BoxOptions(lower=tuple(-half), upper=tuple(half)), 2)
        self._refuse_impossible()
        self._bumps = {piece.name: self._bump(piece) for piece in self._box.pieces[2:]}

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """The sides of the rectangle, of which the bumps take a part of bottom and top, then the bumps."""
        left, right, *walls = self._box.pieces
        arcs = zip(walls, self._bumps.values(), strict=True)
        flat = [replace(wall, area=wall.area - 2.0 * arc.half_width, coordinates=None) for wall, arc in arcs]
        bumps = [Piece(f"{name}_bump", arc, arc.length) for name, arc in self._bumps.items()]
        return (left, right, *flat, *bumps)

    @property
    def volume(self) -> float:
        """length · width minus two circular segments [length²]."""
        return self._box.volume - sum(arc.area for arc in self._bumps.values())

    def contains(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, 2) are in the rectangle and in none of the disks, (N,)."""
        inside = self._box.contains(points)
        for arc in self._bumps.values():
            inside &= arc.signed_distance(points) > 0.0
        return inside

    def cad_shape(self, unit: float) -> Any:
        """The rectangle minus two disks, as a ``netgen.occ`` face with lengths over ``unit``."""
        from netgen import occ

        shape = self._box.cad_shape(unit)
        for name, arc in self._bumps.items():
            disk = occ.WorkPlane().Circle(*in_unit(np.append(arc.centre, arc.radius), unit).tolist()).Face()
            for side in disk.edges:
                side.name = f"{name}_bump"
            shape = shape - disk
        return shape

    @property
    def _height(self) -> float:
        """Height of the bumps above the walls [length]."""
        o = self.options
        return o.radius if o.throat is None else 0.5 * (o.width - o.throat)

    def _bump(self, piece: Piece) -> Arc:
        wall = piece.shape.plane
        assert wall is not None
        foot = wall.closest_point(np.zeros((1, 2)))[0]
        return Arc(foot + (self._height - self.options.radius) * wall.unit_normal, self.options.radius, wall)

    def _refuse_impossible(self) -> None:
        o, height = self.options, self._height
        if 2.0 * height >= o.width:
            allowed = f"less than half of domain.width = {o.width:g}"
            raise SceneError("domain.radius", o.radius, allowed, "Make the bumps smaller, or give a `throat`.")
        if height <= 0.0:
            allowed = f"less than domain.width = {o.width:g}"
            raise SceneError("domain.throat", o.throat, allowed, "Narrow it; a channel without bumps is a box.")
        if height >= 2.0 * o.radius:
            allowed = f"more than {0.5 * height:g}, half of the bumps' height"
            raise SceneError("domain.radius", o.radius, allowed, "Enlarge it, or widen the throat.")
        widest = o.radius if height > o.radius else np.sqrt(height * (2.0 * o.radius - height))
        if 2.0 * widest >= o.length:
            allowed = f"more than {2.0 * widest:g}, the width of the bumps"
            raise SceneError("domain.length", o.length, allowed, "Lengthen the channel, or make the bumps smaller.")
