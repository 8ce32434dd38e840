"""Distances of vertices and facets against a search over faces of every dimension."""

from itertools import combinations, product

import numpy as np
import pytest

from rigidfluid.core.geometry.simplices import facet_to_facet, vertex_to_facet


def naive(first, second):
    """Least distance of two simplices: unconstrained over each pair of faces, kept where the feet lie on the faces."""
    faces = [
        [np.array(face) for count in range(1, len(corners) + 1) for face in combinations(corners, count)]
        for corners in (first, second)
    ]
    return min(_between(*pair) for pair in product(*faces))


def _between(a, b):
    edges = np.concatenate([a[1:] - a[0], b[0] - b[1:]]).T
    weights = np.linalg.lstsq(edges, b[0] - a[0], rcond=None)[0] if edges.size else np.zeros(0)
    s, t = weights[: len(a) - 1], weights[len(a) - 1 :]
    if (weights < 0).any() or s.sum() > 1 or t.sum() > 1:
        return np.inf
    return np.linalg.norm(a[0] + edges[:, : len(s)] @ s - b[0] + edges[:, len(s) :] @ t)


def apart(rng, dimension):
    """Two facets on two sides of a plane, of any shape, sometimes needles, sometimes parallel."""
    corners = rng.normal(size=(2, dimension, dimension)) * np.array([1.0, rng.choice([1.0, 1e-3]), 1.0])[:dimension]
    if rng.random() < 0.3:
        corners[1] = corners[0] + rng.normal(size=dimension)
    corners[0, :, 0] = -np.abs(corners[0, :, 0]) - 0.01
    corners[1, :, 0] = np.abs(corners[1, :, 0])
    return corners


@pytest.mark.parametrize("dimension", [2, 3])
def test_facet_to_facet(dimension):
    rng = np.random.default_rng(0)
    facets = np.arange(2 * dimension, dtype=np.int32).reshape(2, dimension)
    for _ in range(400):
        corners = apart(rng, dimension)
        points = corners.reshape(-1, dimension)
        square, *weights = facet_to_facet(points, facets, 0, 1)
        assert np.sqrt(square) == pytest.approx(naive(*corners), rel=1e-9)
        on_first, on_second = (w @ c for w, c in zip(np.reshape(weights, (2, 3))[:, :dimension], corners, strict=True))
        assert np.linalg.norm(on_first - on_second) == pytest.approx(np.sqrt(square), rel=1e-9)


@pytest.mark.parametrize("dimension", [2, 3])
def test_vertex_to_facet(dimension):
    rng = np.random.default_rng(1)
    facets = np.arange(1, dimension + 1, dtype=np.int32)[None]
    seen = set()
    for _ in range(400):
        points = rng.normal(size=(dimension + 1, dimension))
        square, bits, *weights = vertex_to_facet(points, 0, facets, 0)
        assert np.sqrt(square) == pytest.approx(naive(points[:1], points[1:]), rel=1e-12)
        assert sum(weights) == pytest.approx(1)
        assert [bool(bits >> i & 1) for i in range(3)] == [weight > 0 for weight in weights]
        seen.add(bits)
    assert len(seen) == 2**dimension - 1
