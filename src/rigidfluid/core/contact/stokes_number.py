"""The Stokes number of an impact: what the bodies bring over what the film between them can take."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.contact.loads import inverse_mass, of_both
from rigidfluid.core.model.types import Contacts, FloatArray, Loads


@dataclass(frozen=True, slots=True)
class Film:
    """The fluid between bodies of masses ``loads.mass`` and ``radius`` (n,), that of the ball of equal volume [length];
    ``viscosity``, dynamic [mass·length^(2-d)/time]."""

    viscosity: float
    radius: FloatArray
    loads: Loads

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
        curvature = of_both(1.0 / self.radius, contacts).sum(axis=0)
        resistance = 6.0 / curvature**2 if contacts.normal.shape[1] == 3 else 4.5 / curvature
        with np.errstate(divide="ignore"):
            return np.asarray(1.0 / (np.pi * self.viscosity * resistance * inverse_mass(contacts, self.loads)))
