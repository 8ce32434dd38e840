"""The resistance of a film that is too thin for the mesh."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Loads, Motion
from rigidfluid.errors import SceneError


class LubricationOptions(PartOptions):
    """Keys of a table with law ``lubrication``.

    ``viscosity``: dynamic, of the film, μ [mass·length^(2-d)/time]. ``cutoff``: the gap below which the resistance
    grows no further [length].
    """

    viscosity: float = Field(gt=0, description="Dynamic viscosity μ of the film [mass·length^(2-d)/time]")
    cutoff: float = Field(gt=0, description="Gap below which the resistance grows no further [length]")


class LubricationLaw(ForceLaw):
    """F = -6πμ R² v_n (1/h - 1/range) n in 3D, -3√2 πμ v_n [(R/h)^(3/2) - (R/range)^(3/2)] n in 2D, for gap < range.

    h = max(gap, cutoff), v_n is the relative velocity along the normal, and R the contact's effective radius: of balls
    r_a r_b/(r_a + r_b), the ball's radius at a flat wall, with r_b < 0 in a round hollow, and of ellipsoids what both
    surfaces' curvatures make of it. The terms are the leading ones of a squeezed film; what they give at
    range is taken off, as the mesh resolves a film as thick as that: range is to be the gap where the mesh begins to
    fail. The force takes energy out and holds nothing at rest, so its own force, energy and stiffness are zero.

    A cutoff that is not below range, and surfaces without a known curvature, raise SceneError.

    Notes
    -----
    3D: Cox, Int. J. Multiphase Flow 1 (1974) 343, doi:10.1016/0301-9322(74)90019-6. 2D: the limit of a small gap of
    Jeffrey and Onishi, Q. J. Mech. Appl. Math. 34 (1981) 129, doi:10.1093/qjmam/34.2.129.
    """

    name: ClassVar[str] = "lubrication"
    film: bool = True
    conservative: bool = False
    dissipative: bool = True
    Options: ClassVar[type[PartOptions]] = LubricationOptions
    options: LubricationOptions

    def __init__(self, options: PartOptions, range: float, loads: Loads | None = None) -> None:
        super().__init__(options, range, loads)
        self.require_below_range("cutoff", self.options.cutoff)

    def force(self, contacts: Contacts) -> FloatArray:
        """Zero, (m, d): a film at rest pushes nothing [force]."""
        return np.zeros_like(contacts.normal)

    def energy(self, contacts: Contacts) -> FloatArray:
        """Zero, (m,) [energy]."""
        return np.zeros_like(contacts.gap)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        """Zero, (m,) [force/length]."""
        return np.zeros_like(contacts.gap)

    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """The resistance of the film to squeezing and parting, on ``body_a``, (m, d) [force]."""
        dimension = contacts.normal.shape[1]
        film = np.clip(contacts.gap, self.options.cutoff, self.range)
        radius = _effective_radius(contacts)
        beyond_mesh = _resistance(radius, film, dimension) - _resistance(radius, self.range, dimension)
        speed = np.sum(motion.velocity * contacts.normal, axis=1)
        return np.asarray(-(self.options.viscosity * beyond_mesh * speed)[:, None] * contacts.normal)


def _resistance(radius: FloatArray, film: FloatArray | float, dimension: int) -> FloatArray:
    """Force over μ v_n, (m,) [length in 3D, 1 in 2D]."""
    if dimension == 2:
        return np.asarray(3.0 * np.sqrt(2.0) * np.pi * (radius / film) ** 1.5)
    return np.asarray(6.0 * np.pi * radius**2 / film)


def _effective_radius(contacts: Contacts) -> FloatArray:
    """R, (m,) [length]."""
    lost = np.isnan(contacts.effective_radius)
    if np.any(lost):
        first = int(np.argmax(lost))
        raise SceneError(
            "contact.law",
            f'"{LubricationLaw.name}" with surfaces {contacts.body_a[first]} and {contacts.body_b[first]}, whose gap'
            " has no known curvature",
            "balls, ellipses and ellipsoids, at flat or round walls that they fit into",
            "Keep it to other contacts by `between` or `names`, or leave it out.",
        )
    return contacts.effective_radius
