"""The boundary of a mesh file's fluid, or of its facets where it has no cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facets import LARGEST, Facets, place
from rigidfluid.domains.mesh_file import FIELD, Cells, MeshFile
from rigidfluid.domains.naming import Part, list_parts
from rigidfluid.errors import SceneError

SAME = 1e-9
"""Distance over the size of the domain, below which two points are one [1]."""

_FLAT = 1e-12
"""Distance off the plane z = 0 over the size of the domain, below which points lie in it [1]."""


@dataclass(frozen=True)
class Boundary:
    """``facets`` marked by the file's numbers, the ``names`` of those, and how many ``doubled`` points were joined."""

    facets: Facets
    names: dict[int, str]
    doubled: int

    @property
    def parts(self) -> list[Part]:
        """Parts of the boundary as the file knows them, by ascending number."""
        numbers = np.unique(self.facets.markers).tolist()
        return [Part(number, self.names.get(number), self._look(number)) for number in numbers]

    def _look(self, number: int) -> str:
        chosen = self.facets.vertices[self.facets.markers == number]
        return f"{len(chosen)} facets about {place(self.facets.points[chosen.ravel()])}"


def boundary_of(file: MeshFile, dimension: int, fluid: int | str | None, scale: float) -> Boundary:
    """Boundary of the region of a file that the fluid fills, in 2 or 3 dimensions.

    Points less than SAME apart are joined, and facets without an area left out. ``fluid`` is the number or name of the
    cells that are fluid, None where all have one number; ``scale`` multiplies lengths [1]. Raises SceneError if there
    is no such region, or a facet of its boundary has no number.
    """
    points = _in_space(file, dimension) * scale
    region = _region(file.cells, points, dimension, fluid)
    if len(region):
        vertices, numbers = _boundary_facets(region, file.facets, points)
    else:
        vertices, numbers = file.facets.vertices, file.facets.numbers
    if not len(vertices):
        raise SceneError(FIELD, "neither cells nor facets", f"a mesh in {dimension} dimensions", "Rewrite the file.")
    joined = _joined(points[:, :dimension], vertices)
    doubled = len(np.unique(vertices)) - len(np.unique(joined[vertices]))
    vertices = joined[vertices]
    sound = np.all(np.diff(np.sort(vertices, axis=1), axis=1) > 0, axis=1)
    if not sound.any():
        found = f"{len(vertices)} facets, all without an area"
        raise SceneError(FIELD, found, "facets around a region", "Rewrite the file.")
    if len(region):  # the two sides of a wall without thickness, joined
        _refuse_baffles(Cells(vertices, numbers, file.facets.names), sound & _doubled(vertices), points)
    used, compact = np.unique(vertices[sound], return_inverse=True)
    facets = Facets(points[used, :dimension], compact.reshape(-1, dimension).astype(np.int64), numbers[sound])
    return Boundary(facets, file.facets.names, doubled)


def _in_space(file: MeshFile, dimension: int) -> FloatArray:
    points = file.points
    if not (np.abs(points) <= LARGEST).all():
        raise SceneError(FIELD, "coordinates that are no such numbers", f"those up to {LARGEST:g}", "Rewrite the file.")
    if dimension == 2 and len(points) and np.abs(points[:, 2]).max() > _FLAT * np.abs(points).max():
        found = f"points off the plane z = 0, by up to {np.abs(points[:, 2]).max():.6g}"
        raise SceneError(FIELD, found, "a mesh in the plane, as the scene has 2 dimensions", "Choose another file.")
    return points


def _region(cells: Cells, points: FloatArray, dimension: int, fluid: int | str | None) -> IntArray:
    """The cells that are fluid."""
    numbers = np.unique(cells.numbers).tolist()
    regions = [
        Part(number, cells.names.get(number), f"{np.count_nonzero(cells.numbers == number)} cells")
        for number in numbers
    ]
    if fluid is None:
        if len(regions) > 1:
            remedy = 'Say which is the fluid: `fluid = "…"`.'
            raise SceneError(
                "domain.fluid", f"nothing, and several regions: {list_parts(regions)}", "one of them", remedy
            )
        return cells.vertices
    chosen = [part.number for part in regions if fluid in (part.number, part.name)]
    if not chosen:
        known = list_parts(regions) or "none, as the file has no cells"
        raise SceneError("domain.fluid", f"{fluid!r}, which is no region of the file", known, "Correct or remove it.")
    return cells.vertices[np.isin(cells.numbers, chosen)]


def _boundary_facets(region: IntArray, facets: Cells, points: FloatArray) -> tuple[IntArray, IntArray]:
    """Facets (F, d) of only one cell of the region, and the numbers that the file's facets give them."""
    count = region.shape[1]
    sides = np.concatenate([np.delete(region, k, axis=1) for k in range(count)])
    unique, times = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    outer = unique[times == 1]
    _refuse_baffles(facets, _are_among(facets.vertices, unique[times == 2]), points)
    keys = np.concatenate([outer, np.sort(facets.vertices, axis=1)])
    _, row = np.unique(keys, axis=0, return_inverse=True)
    number_of = dict(zip(row.ravel()[len(outer) :].tolist(), facets.numbers.tolist(), strict=True))
    found = [number_of.get(key) for key in row.ravel()[: len(outer)].tolist()]
    bare = [i for i, number in enumerate(found) if number is None]
    if bare:
        first = place(points[outer[bare[0]]])
        text = f"{len(bare)} facets of the fluid's boundary without a number, the first about {first}"
        raise SceneError(FIELD, text, "a number or name for every facet", "Give all of the boundary physical groups.")
    return outer, np.array(found, dtype=np.int64)


def _refuse_baffles(facets: Cells, thin: BoolArray, points: FloatArray) -> None:
    """Refuse the ``thin`` ones (F,) of ``facets``, with fluid on both sides."""
    if thin.any():
        number = int(facets.numbers[thin][0])
        mine = facets.vertices[thin & (facets.numbers == number)]
        name = f"{number} {facets.names[number]!r}" if number in facets.names else str(number)
        first = place(points[mine[0], : mine.shape[1]])
        found = f"{len(mine)} facets of {name} with fluid on both sides, the first about {first}"
        remedy = "Draw a wall of some thickness there; if it is no wall, take its group out of the file."
        raise SceneError(FIELD, found, "facets with fluid on one side", remedy)


def _doubled(vertices: IntArray) -> BoolArray:
    """Which facets (F,) are there more than once."""
    _, row, times = np.unique(np.sort(vertices, axis=1), axis=0, return_inverse=True, return_counts=True)
    return np.asarray(times[row.ravel()] > 1)


def _are_among(facets: IntArray, others: IntArray) -> BoolArray:
    """Which facets (F,) are among ``others`` (G, d)."""
    corners = np.sort(np.concatenate([facets, others]), axis=1)
    row = np.unique(corners, axis=0, return_inverse=True)[1].ravel()
    return np.isin(row[: len(facets)], row[len(facets) :])


def _joined(points: FloatArray, vertices: IntArray) -> IntArray:
    """Number of the point that stands for each point, (N,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    used = np.unique(vertices)
    size = float(np.ptp(points[used], axis=0).max())
    pairs = used[cKDTree(points[used]).query_pairs(SAME * size, output_type="ndarray")]
    links = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(points),) * 2)
    _, group = connected_components(links, directed=False)
    _, first = np.unique(group, return_index=True)
    return np.asarray(first[group])
