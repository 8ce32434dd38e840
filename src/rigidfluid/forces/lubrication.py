"""The resistance of a film that is too thin for the mesh, to squeezing, sliding, rolling and twisting."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.fluid.material import Material, Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.film_viscosity import film_viscosity
from rigidfluid.core.mechanics.rigid import cross, moment
from rigidfluid.core.model.contacts import normal_part
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Loads, Motion
from rigidfluid.errors import SceneError
from rigidfluid.forces.curved_film import curved_resistance, plane_radii
from rigidfluid.forces.film_resistance import FilmResistance, film_resistance, leading_squeezing


class LubricationOptions(PartOptions):
    """Keys of a table with law ``lubrication``.

    ``viscosity``: dynamic, of the film, μ [mass·length^(2-d)/time]; if not given, that of the fluid, where it varies at
    the shear rates of the film. ``cutoff``: the gap below which the resistance grows no further [length]. ``sliding``:
    whether the film resists sliding, rolling and twisting too; if not, it is the leading term of squeezing. Meshes
    mostly resolve sliding where they do not squeezing.
    """

    viscosity: float | None = Field(
        default=None,
        gt=0,
        description="Dynamic viscosity μ of the film [mass·length^(2-d)/time]; if not given, that of the fluid, where"
        " it varies at the shear rates of the film",
    )
    cutoff: float = Field(gt=0, description="Gap below which the resistance grows no further [length]")
    sliding: bool = Field(
        default=False,
        description="Whether the film resists sliding, rolling and twisting too; if not, squeezing by its leading term"
        " alone",
    )


class LubricationLaw(ForceLaw):
    """F = -μ (N v_n n + S v_t + Q n × w) and the couple C = -μ [(Qᵀ v_t + W n × w) × n + T w_n n] on ``body_a``, for
    gap < range.

    v is the relative velocity of the surfaces half-way between them, v_n along the normal n and v_t across it, w their
    relative angular velocity, w_n its part along n. N, S, Q, W and T are the resistances of `film_resistance` to
    squeezing, sliding, both, rolling and twisting at h = max(gap, cutoff) minus those at range, as the mesh resolves a
    film as thick as that: range is to be the gap where the mesh begins to fail. The leading terms of N are 6πR²/h in 3D
    and 3√2 π (R/h)^(3/2) in 2D, those of the others grow as ln(R/h) and √(R/h); R is the contact's effective radius,
    r_a r_b/(r_a + r_b). Twisting is resisted in 3D alone, and finitely in contact: from a gap of R/10 on that grows by
    3 % between equal balls, by 8 % at a flat wall.

    Ellipsoids have the leading terms alone, with an R, and tensors S, Q and W, by both surfaces' curvatures;
    `curved_film` has them. Without ``sliding`` N is its leading term, and S, Q, W and T are zero. The film
    takes energy out and holds nothing at rest, so its own force, energy and stiffness are zero.

    Without ``viscosity`` μ is the fluid's. One that varies is averaged over the film, `film_viscosity`, at the speeds
    v_n and √(v_t² + (R w_t)²); so one μ stands for all resistances.

    A cutoff that is not below range, no viscosity and no fluid, and surfaces without a known curvature, raise
    SceneError.

    Notes
    -----
    3D: Cox, Int. J. Multiphase Flow 1 (1974) 343, doi:10.1016/0301-9322(74)90019-6; Jeffrey and Onishi, J. Fluid Mech.
    139 (1984) 261, doi:10.1017/S0022112084000355. 2D: the limit of a small gap of Jeffrey and Onishi, Q. J. Mech. Appl.
    Math. 34 (1981) 129, doi:10.1093/qjmam/34.2.129.
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
        self._material = _material(self.options.viscosity, loads)
        self.couples = self.curved = self.options.sliding
        self.round_option = "sliding" if self.options.sliding else ""

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
        """The resistance of the film on ``body_a``, (m, d) [force]."""
        normal, rolling = contacts.normal, -cross(motion.angular_velocity, contacts.normal)
        force = self._resistance(contacts).force(normal, motion.velocity, rolling)
        return -self._viscosity(contacts, motion, rolling)[:, None] * force

    def couple(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """The couple of the film on ``body_a``, (m, k) [force·length]."""
        resistance, rolling = self._resistance(contacts), -cross(motion.angular_velocity, contacts.normal)
        couple = moment(resistance.arm_couple(motion.velocity, rolling), contacts.normal)
        if contacts.normal.shape[1] == 3:
            couple += (resistance.twisting * normal_part(motion.angular_velocity, contacts))[:, None] * contacts.normal
        return -self._viscosity(contacts, motion, rolling)[:, None] * couple

    def _viscosity(self, contacts: Contacts, motion: Motion, rolling: FloatArray) -> FloatArray:
        """Viscosity of the films that move so, (m,) [mass·length^(2-d)/time]; ``rolling`` is n × w."""
        if isinstance(self._material, Newtonian):  # asked in each substep
            return np.full(len(contacts), self._material.dynamic_viscosity)
        closing = normal_part(motion.velocity, contacts)
        along = motion.velocity - closing[:, None] * contacts.normal
        film, radius = np.clip(contacts.gap, self.options.cutoff, self.range), _effective_radius(contacts)
        passing = np.hypot(np.linalg.norm(along, axis=1), radius * np.linalg.norm(rolling, axis=1))
        return film_viscosity(self._material, film, radius, np.abs(closing), passing, contacts.normal.shape[1])

    def _resistance(self, contacts: Contacts) -> FilmResistance:
        """Resistances that the mesh does not resolve."""
        dimension = contacts.normal.shape[1]
        film, end = np.clip(contacts.gap, self.options.cutoff, self.range), np.full(len(contacts), self.range)
        radius = _effective_radius(contacts)
        if self.options.sliding:
            radii = plane_radii(contacts) if dimension == 2 else (contacts.radius_a, contacts.radius_b)
            resistance = film_resistance(film, *radii, dimension).beyond(film_resistance(end, *radii, dimension))
            curved = np.isnan(radii[0]) | np.isnan(radii[1])
            if contacts.curvatures is None or not curved.any():
                return resistance
            rows = (column[curved] for column in (film, end, contacts.curvatures, radius))
            return resistance.with_tensors(curved, curved_resistance(*rows))
        squeezing = leading_squeezing(film, radius, dimension) - leading_squeezing(end, radius, dimension)
        none = np.zeros_like(squeezing)
        return FilmResistance(squeezing, none, none, none, none)


def _material(viscosity: float | None, loads: Loads | None) -> Material:
    """Material of the film: that of a given ``viscosity``, or else the fluid's."""
    if viscosity is not None:
        return Newtonian(viscosity)
    if loads is None or loads.film is None:
        allowed = "a viscosity of the film where there is no fluid to take it from"
        raise SceneError("contact.viscosity", "none", allowed, "Give it, or choose a backend with a fluid.")
    return loads.film.material


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
