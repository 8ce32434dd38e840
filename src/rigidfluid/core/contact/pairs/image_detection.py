"""Contacts of bodies with each other's images between periodic surfaces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from rigidfluid.core.contact.pairs.broad_phase import SKIN
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.types import Contacts, Pose

MakeDetector = Callable[[Sequence[Body], Sequence[Wall]], Detector]

_LISTS = 2


@dataclass(frozen=True)
class _Images:
    """Images near the first cell: of ``body`` (g,), displaced by ``offset`` (g, k) vectors of the lattice.

    They were chosen for a ``reach`` [length] when the bodies, in ``cells`` (n, k), were at ``wrapped`` (n, d) in the
    first one. The ``detector`` sees the n bodies and after them the images.
    """

    body: IntArray
    offset: IntArray
    cells: IntArray
    wrapped: FloatArray
    reach: float
    detector: Detector

    def hold(self, cells: IntArray, wrapped: FloatArray, reach: float) -> bool:
        """Tell whether no other image can be within ``reach`` of a body: none has left its cell, or moved far."""
        if reach > self.reach or not np.array_equal(cells, self.cells):
            return False
        moved = np.sum((wrapped - self.wrapped) ** 2, axis=1)
        return bool(np.all(moved <= (self.reach - reach) ** 2))


class ImageDetection:
    """Contacts between bodies and the images of others, by a detector that sees the bodies in the first cell of the
    ``lattice`` and all images near it.

    A contact is found once, with the image of the body of the higher number that the other meets where it is itself. A
    body does not meet its own images, and walls are the same in all cells. Contacts depend on the pose alone and not on
    poses before, although images are chosen only now and then.
    """

    def __init__(self, make: MakeDetector, bodies: Sequence[Body], walls: Sequence[Wall], lattice: Lattice) -> None:
        self._make, self._bodies, self._walls, self._lattice = make, tuple(bodies), tuple(walls), lattice
        self._radii = np.array([body.bounding_radius for body in bodies])
        self._skin = SKIN * float(self._radii.mean())
        self._lists: list[_Images] = []

    def detect(self, pose: Pose, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach``, no farther than the shortest vector if that is infinite [length], sorted
        by (body_a, body_b)."""
        reach = self._lattice.shortest if np.isinf(reach) else reach
        cells = self._lattice.cells(pose.position)
        wrapped = pose.position - self._lattice.displacement(cells)
        images = self._within(cells, wrapped, reach)
        position = np.concatenate([wrapped, wrapped[images.body] + self._lattice.displacement(images.offset)])
        orientation = np.concatenate([pose.orientation, pose.orientation[images.body]])
        return self._between_bodies(images.detector.detect(Pose(position, orientation), None, reach), images)

    def _within(self, cells: IntArray, wrapped: FloatArray, reach: float) -> _Images:
        """Images that may be within ``reach`` of a body, and some more."""
        wide = reach + self._skin
        for images in self._lists:
            # images for much too far would be right, but slow
            if images.reach <= wide + self._skin and images.hold(cells, wrapped, reach):
                return images
        made = self._made(cells, wrapped, wide)
        self._lists = [made, *self._lists[: _LISTS - 1]]
        return made

    def _made(self, cells: IntArray, wrapped: FloatArray, reach: float) -> _Images:
        lattice, margin = self._lattice, reach + self._radii + self._radii.max()
        coordinates, body, offset = lattice.coordinates(wrapped), [], []
        for shift in _half_of_cells(1 + (margin.max() // lattice.lengths).astype(np.int64)):
            away = np.maximum(coordinates + shift - 1.0, -coordinates - shift) * lattice.lengths
            near = np.flatnonzero(np.all(away <= margin[:, None], axis=1))
            body.append(near)
            offset.append(np.tile(shift, (len(near), 1)))
        which = np.concatenate(body)
        walls = [replace(wall, surface=wall.surface + len(which)) for wall in self._walls]
        detector = self._make([*self._bodies, *(self._bodies[number] for number in which)], walls)
        return _Images(which, np.concatenate(offset), cells, wrapped, reach, detector)

    def _between_bodies(self, found: Contacts, images: _Images) -> Contacts:
        """Contacts of bodies where they are, by those of bodies in the first cell with each other and with images."""
        count = len(self._bodies)
        index = np.concatenate([np.arange(count), images.body])
        offset = np.concatenate([np.zeros_like(images.cells), images.offset])
        other = index[np.minimum(found.body_b, len(index) - 1)]
        found = select(found, (found.body_a < count) & (found.at_wall | (found.body_a != other)))
        a, wall = found.body_a, found.at_wall
        seen = np.where(wall, 0, found.body_b)
        b = np.where(wall, found.body_b - len(images.body), index[seen])
        cell_a, cell_b = images.cells[a], images.cells[index[seen]] - offset[seen]
        turned = ~wall & (b < a)
        frame = np.where(turned[:, None], cell_b, cell_a)
        away = np.where(wall[:, None], 0, np.where(turned[:, None], cell_b - cell_a, cell_a - cell_b))
        there = replace(_turned(found, turned), body_a=np.where(turned, b, a), body_b=np.where(turned, a, b))
        moved, shift = (self._lattice.displacement(each) for each in (frame, away))
        there = replace(there, point_a=there.point_a + moved, point_b=there.point_b + moved, shift=shift)
        return select(there, np.lexsort((*away.T[::-1], there.body_b, there.body_a)))


def _half_of_cells(most: IntArray) -> list[IntArray]:
    """Offsets (k,) of cells up to ``most`` (k,) away along each vector, one of each two opposite ones."""
    every = product(*(range(-each, each + 1) for each in most.tolist()))
    return [np.array(offset, dtype=np.int64) for offset in every if offset > (0,) * len(most)]


def _turned(contacts: Contacts, chosen: BoolArray) -> Contacts:
    """The same contacts, with a and b changed over in those ``chosen`` (m,), but for their numbers."""
    rows = chosen[:, None]
    return replace(
        contacts,
        point_a=np.where(rows, contacts.point_b, contacts.point_a),
        point_b=np.where(rows, contacts.point_a, contacts.point_b),
        normal=np.where(rows, -contacts.normal, contacts.normal),
        radius_a=np.where(chosen, contacts.radius_b, contacts.radius_a),
        radius_b=np.where(chosen, contacts.radius_a, contacts.radius_b),
    )
