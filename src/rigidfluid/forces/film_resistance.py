"""Resistances of the thin film between two round surfaces to squeezing, sliding, rolling and twisting.

Let R = ab/(a + b) be the effective radius of balls of radii a and b (b infinite on a flat wall, negative in a round
hollow), δ = R(1/b - 1/a), x = h/R the gap over R, and L = ln(1/x). Over the viscosity the resistances are, in 3D,

    squeezing  6π [1/x + (9 - 5δ²)/20 L + x (1 + 14s - 63s²)/21 L] R,  s = (1 - δ²)/4
    sliding    π [2 + 6/5 δ² + x (0.304 δ² + 0.72 δ⁴)] L R
    coupling   π [12/5 δ + x (1.44 δ³ - 0.192 δ)] L R²
    rolling    π [24/5 + x (2.016 + 2.88 δ²)] L R³
    twisting   -π [4x + 2.18 x²] L R³ + what it is in contact

and terms x and x² beside them, which are polynomials in δ². In all but the leading terms x is at most `THICK`, and |δ|
at most 1, as it is but in round hollows. In 2D they are the leading terms of a small gap,

    squeezing  3√2 π x^(-3/2)
    sliding, coupling, rolling  √2 π x^(-1/2) (1 + δ², 2δ R, 4R²).

Notes
-----
Terms in L: Jeffrey & Onishi, J. Fluid Mech. 139 (1984) 261, doi:10.1017/S0022112084000355; Goldman, Cox & Brenner,
Chem. Eng. Sci. 22 (1967) 637, doi:10.1016/0009-2509(67)80047-2; of any curvatures Cox, Int. J. Multiphase Flow 1 (1974)
343, doi:10.1016/0301-9322(74)90019-6. 2D: Jeffrey & Onishi, Q. J. Mech. Appl. Math. 34 (1981) 129,
doi:10.1093/qjmam/34.2.129. Twisting: Jeffery, Proc. London Math. Soc. s2-14 (1915) 327, doi:10.1112/plms/s2_14.1.327;
all but its leading term is fitted to that series, to .3 % of the resistance. The terms x and x² of sliding, coupling
and rolling are fitted to the exact resistances in bispherical coordinates of pairs that move as a whole as they like,
up to x = 0.2: differences between two gaps are then within 1.1 %.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray

THICK = 0.2
"""Gap over the effective radius above which the leading terms alone grow no further."""

_SLIDING = (-0.02, 0.88, 23.66, -16.42), (-0.19, -0.89)
_COUPLING = (-3.13, 71.65, -83.64, 30.04), (-1.04, 1.67)
_ROLLING = (19.17, 76.38, -84.99, 24.51), (-1.24, 15.91)
_TWISTING = (-1.21, 14.87, -19.43, 9.33), (-1.65, -3.94)
"""Coefficients of δ⁰, δ², … in the terms x and x²."""


class FilmResistance(NamedTuple):
    """Resistances (m,) over the viscosity to the relative velocity v half-way between the surfaces and the relative
    angular velocity w, as force and couple on a, with n from b to a:

        F = -μ (squeezing v_n n + sliding v_t + coupling n × w)
        C = -μ [(coupling v_t + rolling n × w) × n + twisting w_n n].

    In 3D ``squeezing`` and ``sliding`` are lengths, ``coupling`` length², ``rolling`` and ``twisting`` length³; in 2D
    1, 1, length and length², and nothing twists. ``twisting`` is finite in contact and counted from there: below zero.
    The parts ``sliding``, ``coupling`` and ``rolling`` are tensors (m, d, d) where some surface is no ball's, and C has
    the transpose of ``coupling``.
    """

    squeezing: FloatArray
    sliding: FloatArray
    coupling: FloatArray
    rolling: FloatArray
    twisting: FloatArray

    def beyond(self, other: FilmResistance) -> FilmResistance:
        """Difference from that of ``other``, a thicker film, of which no motion gains energy."""
        more = FilmResistance(*(one - two for one, two in zip(self, other, strict=True)))
        squeezing, sliding, rolling, twisting = (
            np.maximum(part, 0.0) for part in (more.squeezing, more.sliding, more.rolling, more.twisting)
        )
        most = np.sqrt(sliding * rolling)
        return FilmResistance(squeezing, sliding, np.clip(more.coupling, -most, most), rolling, twisting)

    def with_tensors(self, rows: BoolArray, other: FilmResistance) -> FilmResistance:
        """Tensors in place of numbers, those of ``other`` in the ``rows`` (m,)."""
        sliding, coupling, rolling = (
            column[:, None, None] * np.eye(3) for column in (self.sliding, self.coupling, self.rolling)
        )
        mine = FilmResistance(self.squeezing.copy(), sliding, coupling, rolling, self.twisting.copy())
        for column, theirs in zip(mine, other, strict=True):
            column[rows] = theirs
        return mine

    def force(self, normal: FloatArray, velocity: FloatArray, rolling: FloatArray) -> FloatArray:
        """-F/μ (m, d) of v and n × w, ``rolling``, with the ``normal`` n, (m, d) each."""
        closing = np.sum(velocity * normal, axis=1)[:, None] * normal
        resisted = self.squeezing[:, None] * closing + _product(self.sliding, velocity - closing)
        return np.asarray(resisted + _product(self.coupling, rolling))

    def arm_couple(self, velocity: FloatArray, rolling: FloatArray) -> FloatArray:
        """Vectors (m, d) whose product × n is the couple -C/μ without twisting."""
        coupling = self.coupling if self.coupling.ndim == 1 else np.swapaxes(self.coupling, 1, 2)
        return _product(coupling, velocity) + _product(self.rolling, rolling)


def film_resistance(gap: FloatArray, radius_a: FloatArray, radius_b: FloatArray, dimension: int) -> FilmResistance:
    """Resistances of a film as thick as ``gap`` between balls of these radii, (m,) each [length]; ``radius_b`` is
    infinite at a flat wall, negative in a round hollow."""
    with np.errstate(divide="ignore"):  # a ball that fills its hollow
        radius = 1.0 / (1.0 / radius_a + 1.0 / radius_b)
    resistance = _in_the_plane if dimension == 2 else _in_space
    return resistance(gap / radius, radius, 1.0 - 2.0 * radius / radius_a)


def _product(resistance: FloatArray, vectors: FloatArray) -> FloatArray:
    """Numbers (m,) or tensors (m, d, d) times vectors, (m, d)."""
    if resistance.ndim == 1:
        return np.asarray(resistance[:, None] * vectors)
    return np.asarray(np.einsum("mij,mj->mi", resistance, vectors))


def leading_squeezing(gap: FloatArray, radius: FloatArray, dimension: int) -> FloatArray:
    """Leading term of the resistance to squeezing, of any film of an effective ``radius``, (m,) [length in 3D, 1 in
    2D]."""
    if dimension == 2:
        return np.asarray(3.0 * np.sqrt(2.0) * np.pi * (radius / gap) ** 1.5)
    return np.asarray(6.0 * np.pi * radius**2 / gap)


def _in_space(x: FloatArray, radius: FloatArray, unlike: FloatArray) -> FilmResistance:
    """Resistances in 3D at x = h/R, with ``unlike`` δ."""
    log, thin, d = -np.log(x), np.minimum(x, THICK), np.clip(unlike, -1.0, 1.0)
    thin_log, s = -thin * np.log(thin), 0.25 * (1.0 - d**2)
    squeezing = 1.0 / x + (9.0 - 5.0 * d**2) / 20.0 * log + (1.0 + 14.0 * s - 63.0 * s**2) / 21.0 * thin_log
    sliding = np.pi * (2.0 + 1.2 * unlike**2) * log + np.pi * (0.304 * d**2 + 0.72 * d**4) * thin_log
    coupling = np.pi * 2.4 * unlike * log + np.pi * (1.44 * d**3 - 0.192 * d) * thin_log
    rolling = np.pi * 4.8 * log + np.pi * (2.016 + 2.88 * d**2) * thin_log
    return FilmResistance(
        6.0 * np.pi * squeezing * radius,
        (sliding + _fitted(_SLIDING, thin, d)) * radius,
        (coupling + d * _fitted(_COUPLING, thin, d)) * radius**2,
        (rolling + _fitted(_ROLLING, thin, d)) * radius**3,
        np.pi * (_fitted(_TWISTING, thin, d) - (4.0 + 2.18 * thin) * thin_log) * radius**3,
    )


def _fitted(coefficients: tuple[tuple[float, ...], ...], thin: FloatArray, d: FloatArray) -> FloatArray:
    """Terms x and x²."""
    first, second = (np.polynomial.polynomial.polyval(d**2, one) for one in coefficients)
    return np.asarray(first * thin + second * thin**2)


def _in_the_plane(x: FloatArray, radius: FloatArray, unlike: FloatArray) -> FilmResistance:
    """Resistances in 2D at x = h/R, with ``unlike`` δ."""
    along = np.sqrt(2.0 / x) * np.pi
    return FilmResistance(
        3.0 * along / x,
        along * (1.0 + unlike**2),
        2.0 * along * unlike * radius,
        4.0 * along * radius**2,
        np.zeros_like(along),
    )
