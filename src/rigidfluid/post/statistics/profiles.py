"""Profiles across the domain: how much of each layer is solid, and how fast bodies are there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.samples import Samples

LAYERS = 20


class Profile(NamedTuple):
    """Layers across an axis: their middles ``place`` (l,) [length], the ``fraction`` of bodies in them (l,) [1], and
    the mean ``velocity`` (l, d) of that part of bodies [length/time], not a number where there are none."""

    axis: int
    place: FloatArray
    fraction: Mean
    velocity: Mean


def profile(samples: Samples, axis: int) -> Profile:
    """Profile across ``axis``, with bodies as balls of their volume, cut by the layers."""
    edges = np.linspace(samples.lower[axis], samples.upper[axis], LAYERS + 1)
    inside = np.sum([_inside(samples, edges, place) for place in _places(samples, axis)], axis=0)
    layer = samples.volume / LAYERS
    moved = np.einsum("sln,snd->sld", inside, samples.velocity)
    solid = inside.sum(axis=2)
    share = solid.mean(axis=0)[:, None]
    velocity = np.divide(moved.mean(axis=0), share, out=np.full(moved.shape[1:], np.nan), where=share > 0.0)
    off = np.divide(
        mean(moved - velocity * solid[..., None]).error, share, out=np.full_like(velocity, np.nan), where=share > 0.0
    )
    return Profile(axis, 0.5 * (edges[1:] + edges[:-1]), mean(solid / layer), Mean(velocity, off))


def _places(samples: Samples, axis: int) -> Sequence[FloatArray]:
    """Coordinates (s, n) of the bodies along an axis, and along a period those of the images next to them [length]."""
    place = samples.position[..., axis]
    if not samples.periodic[axis]:
        return [place]
    length = samples.period[axis]
    first = samples.lower[axis] + np.mod(place - samples.lower[axis], length)
    return [first - length, first, first + length]


def _inside(samples: Samples, edges: FloatArray, place: FloatArray) -> FloatArray:
    """Volume of each body between the edges (s, l, n) [length^d]."""
    heights = (edges[:, None] - place[:, None, :]) / samples.radius
    below = _share_below(np.clip(heights, -1.0, 1.0), samples.dimension) * samples.body_volume
    return np.diff(below, axis=1)


def _share_below(height: FloatArray, dimension: int) -> FloatArray:
    """Share of a ball below a ``height`` over its radius, from -1 to 1."""
    if dimension == 3:
        return np.asarray(0.25 * (2.0 + 3.0 * height - height**3))
    return np.asarray((0.5 * np.pi + np.arcsin(height) + height * np.sqrt(1.0 - height**2)) / np.pi)
