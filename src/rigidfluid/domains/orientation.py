"""Facets of a closed surface, all turned towards the fluid inside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets, enclosed_volume
from rigidfluid.core.geometry.ridges import ridges_of
from rigidfluid.errors import SceneError


def facing_the_fluid(facets: Facets, at: str) -> Facets:
    """The same facets, in such an order of their corners that all normals point into the fluid.

    The fluid lies within an odd number of closed surfaces: inside the outermost, outside those within it.

    Messages say that the facets come from ``at``. Raises SceneError, with the place, if a surface is open, branches or
    has one side only, or if the fluid is in several regions.
    """
    _refuse_open(facets, at)
    flip, surface = _turned_alike(facets, at)
    facets = _flipped(facets, flip)
    around: list[FloatArray] = []
    for number in range(int(surface.max()) + 1):
        mine, others = surface == number, surface != number
        outwards = enclosed_volume(facets.points, facets.vertices[mine]) > 0.0
        within = _depth(facets, surface, facets.points[facets.vertices[mine][0, 0]], others)
        facets = _flipped(facets, mine & (outwards == (within % 2 == 0)))
        if within % 2 == 0:
            around.append(facets.points[facets.vertices[mine]].mean(axis=(0, 1)))
    if len(around) > 1:
        places = " and ".join(str(middle.round(12).tolist()) for middle in around[:2])
        found = f"fluid in {len(around)} regions apart from each other, the first two about {places}"
        raise SceneError(at, found, "one region, as pressures of two are not related", "Make a scene of each.")
    return facets


def _refuse_open(facets: Facets, at: str) -> None:
    unique, count, *_ = ridges_of(facets.vertices)
    what = "corner" if facets.vertices.shape[1] == 2 else "edge"
    for wrong, found in ((count == 1, "an open surface"), (count > 2, "surfaces that branch")):
        if wrong.any():
            places = facets.points[unique[np.argmax(wrong)]].round(12).tolist()
            text = f"{found}: {np.count_nonzero(wrong)} free {what}s" if count[wrong][0] == 1 else found
            remedy = "Close the hole there." if count[wrong][0] == 1 else "Remove the facets that do not belong there."
            raise SceneError(at, f"{text}, the first at {places}", f"two facets at each {what}", remedy)


def _turned_alike(facets: Facets, at: str) -> tuple[BoolArray, IntArray]:
    """Which facets (F,) must be turned round so that neighbours go round alike, and the surface each is on (F,).

    Each facet is there twice, as it is and turned round, and linked to what its neighbours then are.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ridges = ridges_of(facets.vertices)
    count, d = facets.vertices.shape
    order = np.argsort(ridges.number.ravel(), kind="stable").reshape(-1, 2)
    first, second = order.T // d
    alike = (np.diff(ridges.sense.ravel()[order], axis=1)[:, 0] != 0).astype(np.int64)
    rows = np.concatenate([first, first + count])
    columns = np.concatenate([second + count * (1 - alike), second + count * alike])
    links = coo_array((np.ones(len(rows)), (rows, columns)), shape=(2 * count, 2 * count))
    _, side = connected_components(links, directed=False)
    as_is, turned = side[:count], side[count:]
    if np.any(as_is == turned):
        place = facets.points[facets.vertices[np.argmax(as_is == turned)]].mean(axis=0).round(12).tolist()
        raise SceneError(at, f"a surface with one side only, at {place}", "surfaces with two sides", "Mend it there.")
    _, surface = np.unique(np.minimum(as_is, turned), return_inverse=True)
    return np.asarray(turned < as_is), surface.astype(np.int64)


def _flipped(facets: Facets, flip: BoolArray) -> Facets:
    vertices = facets.vertices.copy()
    vertices[flip] = vertices[flip][:, ::-1]
    return replace(facets, vertices=vertices)


def _depth(facets: Facets, surface: IntArray, point: FloatArray, others: BoolArray) -> int:
    """Number of the other surfaces that are around a point."""
    around = 0
    for number in np.unique(surface[others]):
        one = facets.part(surface == number)
        outwards = enclosed_volume(one.points, one.vertices) > 0.0
        inside = FacetSurface(one).signed_distance(point[None])[0] < 0.0
        around += bool(inside == outwards)
    return around
