"""Pair distribution: how many bodies are at a distance of one, over how many would be if places were independent."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.samples import Samples

BINS = 60
_ANGLES = 64
_RADII = 4
"""Nodes of the quadrature over each angle, and across a shell."""


class PairDistribution(NamedTuple):
    """g (b,) at ``distance`` (b,) between centres [length]."""

    distance: FloatArray
    value: Mean


def pair_distribution(samples: Samples) -> PairDistribution:
    """g(r) = pairs at r / those of places that are independent and even in the box that centres may be in.

    The box is the domain less a mean radius at each wall, so that walls change nothing for independent places. The
    greatest distance is half of its least side. Along periods the distance is that of the nearest images. States with
    fewer than two bodies have none.
    """
    walls = np.where(samples.periodic, 0.0, 2.0 * samples.radius.mean())
    sides = np.maximum(samples.upper - samples.lower - walls, 1e-9 * samples.radius.mean())
    edges = np.linspace(0.0, max(0.5 * sides.min(), 4.0 * samples.radius.mean()), BINS + 1)
    shares = shell_shares(edges, sides, samples.periodic)

    def ratio(position: FloatArray) -> FloatArray:
        expected = 0.5 * len(position) * (len(position) - 1) * shares
        return np.divide(_counts(samples, position, edges), expected, out=np.zeros(BINS), where=expected > 0.0)

    return PairDistribution(0.5 * (edges[1:] + edges[:-1]), mean(samples.map_states(ratio, samples.position, least=2)))


def _counts(samples: Samples, position: FloatArray, edges: FloatArray) -> FloatArray:
    """Pairs of places (n, d) between two ``edges`` apart, by nearest images along periods, (b,) [1]."""
    sides = np.where(samples.periodic, samples.period, 0.0)
    inside = position - samples.lower
    inside -= sides * np.floor(inside / np.where(samples.periodic, sides, 1.0))
    tree = cKDTree(np.where((inside < sides) | ~samples.periodic, inside, 0.0), boxsize=sides)
    return np.asarray(0.5 * np.diff(tree.count_neighbors(tree, edges)))


def shell_shares(edges: FloatArray, sides: FloatArray, periodic: BoolArray) -> FloatArray:
    """Probability (b,) that two independent places in a box with these ``sides`` (d,) are between two ``edges`` apart.

    The difference u of two places has the density ∏ (L - |u|)/L², that of nearest images along a period 1/L.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_ANGLES)
    angle, part = 0.25 * np.pi * (nodes + 1.0), 0.25 * np.pi * weights
    if len(sides) == 2:
        directions, parts = np.stack([np.cos(angle), np.sin(angle)]), 4.0 * part
    else:
        height, heights = 0.5 * (nodes + 1.0), 0.5 * weights
        across = np.sqrt(1.0 - height**2)
        flat = np.stack([np.outer(np.cos(angle), across), np.outer(np.sin(angle), across)])
        directions = np.concatenate([flat, np.broadcast_to(height, flat[:1].shape)]).reshape(3, -1)
        parts = 8.0 * np.outer(part, heights).ravel()
    half, place = 0.5 * np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    few, portions = np.polynomial.legendre.leggauss(_RADII)
    radius = place[:, None] + half[:, None] * few
    density = np.ones((*radius.shape, directions.shape[1]))
    for side, direction, wraps in zip(sides, directions, periodic, strict=True):
        apart = radius[..., None] * direction
        density *= np.where(apart <= 0.5 * side, 1.0, 0.0) / side if wraps else np.maximum(side - apart, 0.0) / side**2
    shells = (density @ parts) * radius ** (len(sides) - 1)
    return np.asarray(half * (shells @ portions))
