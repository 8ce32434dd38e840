"""Profiles across the domain: how much of each layer is solid, and how fast bodies and fluid are there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import cross
from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.fluid_layers import FluidLayers
from rigidfluid.post.statistics.samples import Samples

LAYERS = 20


class Profile(NamedTuple):
    """Layers across an axis: their middles ``place`` (l,) [length], the ``fraction`` of bodies in them (l,) [1], and
    the mean ``velocity`` (l, d) of that part of bodies [length/time], not a number where there are none, and the
    ``fluctuations`` (l, d) of the velocities of their centres from the mean in the layer; with fields those of the
    ``fluid`` and of both, the ``mixture``, with bodies that do not move."""

    axis: int
    place: FloatArray
    fraction: Mean
    velocity: Mean
    fluctuations: Mean
    fluid: Mean | None
    mixture: Mean | None


def profile(samples: Samples, axis: int, fluid: FluidLayers | None) -> Profile:
    """Profile across ``axis``, with bodies as balls of their volume, cut by the layers."""
    edges = np.linspace(samples.lower[axis], samples.upper[axis], LAYERS + 1)
    inside, moved = _solid_layers(samples, edges, axis)
    volume = inside.sum(axis=2)
    share, velocity = mean(volume / (samples.volume / LAYERS)), _velocity(moved, volume)
    place, spread = 0.5 * (edges[1:] + edges[:-1]), _fluctuations(samples.zero_without(samples.velocity), inside)
    if fluid is None:
        return Profile(axis, place, share, velocity, spread, None, None)
    inside, moved = _solid_layers(fluid.samples, edges, axis)
    mixture = _velocity(fluid.moved + moved, fluid.volume + inside.sum(axis=2))
    return Profile(axis, place, share, velocity, spread, _velocity(fluid.moved, fluid.volume), mixture)


def _velocity(moved: FloatArray, volume: FloatArray) -> Mean:
    """Velocity (l, d) of what has a ``volume`` (s, l), the mean over all of it, by the integral ``moved`` (s, l, d) of
    its velocity; not a number where there is nothing [length/time]."""
    whole = volume.mean(axis=0)[:, None]
    velocity = _over(moved.mean(axis=0), whole)
    return Mean(velocity, _over(mean(moved - velocity * volume[..., None]).error, whole))


def _fluctuations(velocity: FloatArray, inside: FloatArray) -> Mean:
    """Standard deviation (l, d) of velocities (s, n, d) of bodies from their mean in a layer, each counted by its
    volume ``inside`` (s, l, n); not a number where there is nothing [length/time]."""
    volume, near_zero = inside.sum(axis=2), velocity - velocity.mean(axis=(0, 1))
    first, second = (np.einsum("sln,snd->sld", inside, near_zero**power) for power in (1, 2))
    average = _over(first.mean(axis=0), volume.mean(axis=0)[:, None])
    variance = _velocity(second - 2.0 * average * first + average**2 * volume[..., None], volume)
    deviation = np.sqrt(np.maximum(variance.value, 0.0))
    return Mean(deviation, _over(0.5 * variance.error, deviation))


def _over(values: FloatArray, whole: FloatArray) -> FloatArray:
    """Values (l, d) over a ``whole``, not a number where that is nothing."""
    return np.divide(values, whole, out=np.full_like(values, np.nan), where=whole > 0.0)


def _solid_layers(samples: Samples, edges: FloatArray, axis: int) -> tuple[FloatArray, FloatArray]:
    """Volume (s, l, n) of each body between the edges, none of one that is not there [length^d], and the integral (s,
    l, d) of the velocity U + ω × r of the points of all over it [length^(d+1)/time]."""
    velocity, spin = (samples.zero_without(one) for one in (samples.velocity, samples.angular_velocity))
    turning = cross(spin, np.broadcast_to(np.eye(samples.dimension)[axis], velocity.shape))
    slices = [_slices(samples, edges, place) for place in _places(samples, axis)]
    there = samples.present[:, None]
    inside, moment = (np.where(there, np.sum(parts, axis=0), 0.0) for parts in zip(*slices, strict=True))
    moved = np.einsum("sln,snd->sld", inside, velocity) + np.einsum("sln,snd->sld", moment, turning)
    return inside, moved


def _places(samples: Samples, axis: int) -> Sequence[FloatArray]:
    """Coordinates (s, n) of the bodies along an axis, and along a period those of the images next to them [length]."""
    place = samples.position[..., axis]
    if not samples.periodic[axis]:
        return [place]
    length = samples.period[axis]
    first = samples.lower[axis] + np.mod(place - samples.lower[axis], length)
    return [first - length, first, first + length]


def _slices(samples: Samples, edges: FloatArray, place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Volume of each body between the edges (s, l, n) [length^d], and its first moment about the body's centre
    [length^(d+1)]."""
    heights = np.clip((edges[:, None] - place[:, None, :]) / samples.radius, -1.0, 1.0)
    below = _share_below(heights, samples.dimension) * samples.body_volume
    moment = _moment_below(heights, samples.dimension) * samples.radius ** (samples.dimension + 1)
    return np.diff(below, axis=1), np.diff(moment, axis=1)


def _share_below(height: FloatArray, dimension: int) -> FloatArray:
    """Share of a ball below a ``height`` over its radius, from -1 to 1."""
    if dimension == 3:
        return np.asarray(0.25 * (2.0 + 3.0 * height - height**3))
    return np.asarray((0.5 * np.pi + np.arcsin(height) + height * np.sqrt(1.0 - height**2)) / np.pi)


def _moment_below(height: FloatArray, dimension: int) -> FloatArray:
    """First moment of a unit ball's part below a ``height``, from -1 to 1."""
    across = 1.0 - height**2
    return np.asarray(-0.25 * np.pi * across**2 if dimension == 3 else -2.0 / 3.0 * across**1.5)
