"""Vectors of three numbers in compiled loops."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from math import sqrt

from numba import njit

_kernel = njit(cache=True, nogil=True, error_model="numpy")


@_kernel
def triple(v):
    """Triple of an array (3,)."""
    return (v[0], v[1], v[2])


@_kernel
def dot(u, v):
    """Product u·v."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@_kernel
def cross(u, v):
    """Product u × v."""
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


@_kernel
def plus(u, factor, v):
    """Sum u + factor v."""
    return (u[0] + factor * v[0], u[1] + factor * v[1], u[2] + factor * v[2])


@_kernel
def less(u, v):
    """Difference u - v."""
    return (u[0] - v[0], u[1] - v[1], u[2] - v[2])


@_kernel
def times(factor, u):
    """Multiple factor u."""
    return (factor * u[0], factor * u[1], factor * u[2])


@_kernel
def unit(u):
    """Unit vector along u, no numbers if it has no direction."""
    return times(1.0 / sqrt(dot(u, u)), u)


@_kernel
def turned(r, v):
    """Product R v of an array (3, 3)."""
    return (
        r[0, 0] * v[0] + r[0, 1] * v[1] + r[0, 2] * v[2],
        r[1, 0] * v[0] + r[1, 1] * v[1] + r[1, 2] * v[2],
        r[2, 0] * v[0] + r[2, 1] * v[1] + r[2, 2] * v[2],
    )


@_kernel
def turned_back(r, v):
    """Product Rᵀ v of an array (3, 3)."""
    return (
        r[0, 0] * v[0] + r[1, 0] * v[1] + r[2, 0] * v[2],
        r[0, 1] * v[0] + r[1, 1] * v[1] + r[2, 1] * v[2],
        r[0, 2] * v[0] + r[1, 2] * v[1] + r[2, 2] * v[2],
    )
