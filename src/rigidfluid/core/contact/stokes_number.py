"""The Stokes number of an impact: inertia of the bodies over resistance of the film, and what a film takes of it."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from rigidfluid.core.contact.loads import inverse_mass, of_both
from rigidfluid.core.model.types import Contacts, FloatArray, Loads


FILM_EDGE = 1.0
"""The film begins at a gap of this part of the radius; what the fluid does further out is drag."""


@dataclass(frozen=True, slots=True)
class Film:
    """The fluid between bodies of masses ``loads.mass`` and ``radius`` (n,), that of the ball of equal volume [length];
    ``viscosity``, dynamic [mass·length^(2-d)/time]; ``finest_cell`` of the mesh, infinite where the mesh resolves no
    film [length]."""

    viscosity: float
    radius: FloatArray
    loads: Loads
    finest_cell: float

    def stokes_number(self, contacts: Contacts) -> FloatArray:
        """St = m v/(6πμ R²) in 3D and 2 m v/(9πμ R) in 2D, for a closing speed v of one.

        m is the effective mass, with the fluid that moves with the bodies, and R = r_a r_b/(r_a + r_b), r_a at a wall:
        for a ball at a wall both are (ρ_s + C_m ρ_f) D v/(9μ), with the density of a body and its added mass.

        Parameters
        ----------
        contacts : Contacts
            The m contacts.

        Returns
        -------
        (m,) array
            St/v, infinite between two bodies of given twist [time/length].

        Notes
        -----
        Legendre, Daniel and Guiraud, Phys. Fluids 17 (2005) 097105, doi:10.1063/1.2010527; for two balls Yang and Hunt,
        Phys. Fluids 18 (2006) 121506, doi:10.1063/1.2396925.
        """
        curvature = self._curvature(contacts)
        resistance = 6.0 / curvature**2 if contacts.normal.shape[1] == 3 else 4.5 / curvature
        with np.errstate(divide="ignore"):
            return np.asarray(1.0 / (np.pi * self.viscosity * resistance * inverse_mass(contacts, self.loads)))

    def taken(self, contacts: Contacts, gap: FloatArray) -> FloatArray:
        """By how much the resolved film lowers St on the way from its edge to the ``gap``, at any speed.

        A film of resistance λ(h) takes ∫ λ dh/m of the speed. With x = h/R it takes of St, on the way from x to 1/2,

            3D: ∫ dx/x,   2D: (2√2/3) ∫ (1 + 21/20 x) x^(-3/2) dx,

        the first of the squeezed film of a ball, and the first two terms of the exact resistance of a cylinder at a
        wall, 4πμ/(α - tanh α) with cosh α = 1 + x, which is within 2 % of them up to x = 1.

        Parameters
        ----------
        contacts : Contacts
            The m contacts.
        gap : (m,) array
            Up to which [length]; below h²/R cells of the size h resolve no film.

        Returns
        -------
        (m,) array
            Of St [1].

        Notes
        -----
        Jeffrey and Onishi, Q. J. Mech. Appl. Math. 34 (1981) 129, doi:10.1093/qjmam/34.2.129.
        """
        curvature = self._curvature(contacts)
        narrow = np.clip(np.maximum(gap, self.finest_cell**2 * curvature) * curvature, None, FILM_EDGE)
        if contacts.normal.shape[1] == 3:
            return np.asarray(np.log(FILM_EDGE / narrow))
        return np.asarray(4.0 * sqrt(2.0) / 3.0 * (_cylinder_film(narrow) - _cylinder_film(FILM_EDGE)))

    def _curvature(self, contacts: Contacts) -> FloatArray:
        """1/R (m,) [1/length]."""
        return np.asarray(of_both(1.0 / self.radius, contacts).sum(axis=0))


def _cylinder_film(x: FloatArray | float) -> FloatArray:
    return np.asarray(x**-0.5 - 1.05 * x**0.5)
