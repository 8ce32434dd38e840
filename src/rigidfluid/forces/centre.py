"""The paper's law for balls: a force along the line of centres."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.interfaces import ForceLaw, PartOptions
from rigidfluid.core.types import BoolArray, Contacts, FloatArray
from rigidfluid.errors import SceneError


class CentreOptions(PartOptions):
    """Keys of the ``[contact]`` table with law ``centre``.

    ``epsilon``: stiffness parameter ε [length³/force]; the smaller, the stiffer.
    ``epsilon_wall``: the same for walls [length³/force]; ``epsilon`` where it is not given.
    """

    epsilon: float = Field(gt=0, description="Stiffness parameter ε; smaller is stiffer [length^3/force]")
    epsilon_wall: float | None = Field(
        default=None, gt=0, description="The same against walls; epsilon if not given [length^3/force]"
    )


class CentreLaw(ForceLaw):
    """F = (1/ε)(x_i - x_j)(range - gap)² for gap ≤ range, of length (R + gap)(range - gap)²/ε, R = r_i + r_j.

    For a wall x_j is the centre of the tangent imaginary ball, so that R = 2r. The energy, with w = range - gap, is
    U = [(R + range) w³/3 - w⁴/4]/ε. Both hold for overlap as well, up to a common centre.

    Parameters
    ----------
    options : CentreOptions
        ``epsilon`` and ``epsilon_wall`` [length³/force].
    range : float
        The gap above which the law is zero [length].

    Notes
    -----
    Van Landeghem et al., arXiv 2402.19093, the short-range model for spheres.
    """

    name: ClassVar[str] = "centre"
    balls_only: ClassVar[bool] = True
    Options: ClassVar[type[PartOptions]] = CentreOptions
    options: CentreOptions

    def force(self, contacts: Contacts) -> FloatArray:
        """(R + gap)(range - gap)²/ε along the normal on ``body_a``, (m, d) [force]."""
        magnitude = (_reach(contacts) + contacts.gap) * self._closeness(contacts) ** 2 / self._epsilon(contacts)
        return magnitude[:, None] * contacts.normal

    def energy(self, contacts: Contacts) -> FloatArray:
        """U = [(R + range) w³/3 - w⁴/4]/ε, (m,), w = range - gap [energy]."""
        closeness = self._closeness(contacts)
        work = (_reach(contacts) + self.range) * closeness**3 / 3 - closeness**4 / 4
        return work / self._epsilon(contacts)

    def _closeness(self, contacts: Contacts) -> FloatArray:
        return np.maximum(self.range - contacts.gap, 0.0)

    def _epsilon(self, contacts: Contacts) -> FloatArray:
        on_wall = self.options.epsilon if self.options.epsilon_wall is None else self.options.epsilon_wall
        return np.where(_on_wall(contacts), on_wall, self.options.epsilon)


def _on_wall(contacts: Contacts) -> BoolArray:
    return np.isinf(contacts.radius_b)


def _reach(contacts: Contacts) -> FloatArray:
    """R, the distance of the centres where the surfaces touch (m,) [length]."""
    _require_balls(contacts)
    return contacts.radius_a + np.where(_on_wall(contacts), contacts.radius_a, contacts.radius_b)


def _require_balls(contacts: Contacts) -> None:
    unknown = np.isnan(contacts.radius_a) | np.isnan(contacts.radius_b)
    if not np.any(unknown):
        return
    first = int(np.argmax(unknown))
    raise SceneError(
        "contact.law",
        f'"centre" with surfaces {contacts.body_a[first]} and {contacts.body_b[first]}, not both round',
        "balls and flat walls, because the centre law needs balls",
        "Use a law of the gap alone for these shapes.",
    )
