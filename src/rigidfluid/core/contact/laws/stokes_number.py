"""Stokes number of an impact: body inertia over viscous film resistance, and its loss in a film."""

from __future__ import annotations

from functools import cache
from math import sqrt

import numpy as np

from rigidfluid.core.contact.laws.loads import closing_speed, inverse_mass, pair_values
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.film_viscosity import film_viscosity
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.types import Contacts, Film, Loads

_PLACES = 24

FILM_EDGE = 1.0
"""Gap over the radius at which the film begins; there it resists about as much as the fluid far from walls."""


def stokes_number(contacts: Contacts, film: Film, loads: Loads) -> FloatArray:
    """Stokes number over the closing speed v (m,), infinite between two bodies of prescribed twist [time/length]: St =
    m v/(6πμ R²) in 3D and 2 m v/(9πμ R) in 2D.

    m is the effective mass, with the fluid that moves with the bodies, and R = r_a r_b/(r_a + r_b), r_a at a wall: for
    a ball at a wall both are (ρ_s + C_m ρ_f) D v/(9μ), with the density of a body and its added mass (Legendre, Daniel
    and Guiraud, Phys. Fluids 17 (2005) 097105, doi:10.1063/1.2010527; for two balls Yang and Hunt, Phys. Fluids 18
    (2006) 121506, doi:10.1063/1.2396925). A viscosity that varies is that at the film's edge and the expected speed.
    """
    curvature = _curvature(contacts, film)
    per_viscosity = 6.0 / curvature**2 if contacts.normal.shape[1] == 3 else 4.5 / curvature
    resistance = np.pi * _edge_viscosity(contacts, film, loads) * per_viscosity
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / (resistance * inverse_mass(contacts, loads)))


def stokes_number_taken(contacts: Contacts, film: Film, loads: Loads, gap: float) -> FloatArray:
    """Loss of St in the resolved film on the way from its edge to the ``gap``, (m,) [1]: the same at any speed, but
    where the viscosity varies, which is then that at the expected speed.

    A film of resistance λ(h) takes ∫ λ dh/m of the speed. The loss of St on the way from its edge to x = h/R is

        3D: ∫ dx/x,   2D: (2√2/3) ∫ (1 + 21/20 x) x^(-3/2) dx,

    the first of the squeezed film of a ball, and the first two terms of the exact resistance of a cylinder at a wall,
    4πμ/(α - tanh α) with cosh α = 1 + x (Jeffrey and Onishi, Q. J. Mech. Appl. Math. 34 (1981) 129,
    doi:10.1093/qjmam/34.2.129), which is within 2 % of them up to x = 1. Cells of the size c resolve no film below
    c²/R.
    """
    curvature = _curvature(contacts, film)
    narrow = np.minimum(np.maximum(gap, film.finest_cell**2 * curvature) * curvature, FILM_EDGE)
    if isinstance(film.material, GeneralisedNewtonian):
        return _taken_by_parts(contacts, film, loads, narrow)
    if contacts.normal.shape[1] == 3:
        return np.asarray(np.log(FILM_EDGE / narrow))
    return 4.0 * sqrt(2.0) / 3.0 * (_cylinder_film(narrow) - _cylinder_film(np.array(FILM_EDGE)))


def _taken_by_parts(contacts: Contacts, film: Film, loads: Loads, narrow: FloatArray) -> FloatArray:
    """The same integral from ``narrow`` x (m,) to the edge, its integrand times the viscosity over that at the edge."""
    dimension, width = contacts.normal.shape[1], np.log(FILM_EDGE / narrow)
    places, weight = _gauss_points()
    x = FILM_EDGE * np.exp(-0.5 * (1.0 - places)[:, None] * width)
    viscosity = np.array([_viscosity(contacts, film, loads, part) for part in x])
    relative = viscosity / _edge_viscosity(contacts, film, loads)
    if dimension == 2:
        relative *= 2.0 * sqrt(2.0) / 3.0 * (1.0 + 1.05 * x) / np.sqrt(x)
    return np.asarray(0.5 * width * (weight @ relative))


@cache
def _gauss_points() -> tuple[FloatArray, FloatArray]:
    """Points and weights between -1 and 1."""
    return np.polynomial.legendre.leggauss(_PLACES)


def _edge_viscosity(contacts: Contacts, film: Film, loads: Loads) -> FloatArray:
    return _viscosity(contacts, film, loads, np.full(len(contacts), FILM_EDGE))


def _viscosity(contacts: Contacts, film: Film, loads: Loads, x: FloatArray) -> FloatArray:
    """Viscosity of films x = h/R thick at the expected speed, (m,) [mass·length^(2-d)/time]."""
    radius, speed = 1.0 / _curvature(contacts, film), closing_speed(contacts, loads)
    passing = np.zeros_like(speed)
    return film_viscosity(film.material, x * radius, radius, speed, passing, contacts.normal.shape[1])


def _curvature(contacts: Contacts, film: Film) -> FloatArray:
    """Curvature 1/R (m,) [1/length]."""
    return np.asarray(pair_values(1.0 / film.radius, contacts).sum(axis=0))


def _cylinder_film(x: FloatArray) -> FloatArray:
    return np.asarray(x**-0.5 - 1.05 * x**0.5)
