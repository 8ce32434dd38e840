"""Measures of integrals over straight and curved cells, which differ in their quadrature."""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx.mesh import meshtags

from rigidfluid.backends.dolfinx.space import Space
from rigidfluid.core.geometry.arrays import IntArray

_STRAIGHT, _CURVED = 1, 2
_DEGREE_IN_CURVED_CELLS = {2: 6, 3: 7}
"""Degree of convection in curved cells: 2 + 1 + 2 and d - 1 of the map's adjugate."""


class Measures:
    """Measures over the cells of a ``space``."""

    def __init__(self, space: Space) -> None:
        self._space = space
        d = space.numbering.dimension
        self._curved, self._degree = space.curved, _DEGREE_IN_CURVED_CELLS[d]
        tags = None
        if space.curved is not None:
            kinds = np.where(space.curved, _CURVED, _STRAIGHT).astype(np.int32)
            tags = meshtags(space.mesh, d, np.arange(len(kinds), dtype=np.int32), kinds)
        self._dx = ufl.Measure("dx", domain=space.mesh, subdomain_data=tags)

    def over(self, integrand: Any, degree: int) -> Any:
        """Integral of an integrand that has so high a degree in straight cells."""
        return sum(integrand * dx for _, dx, _ in self.kinds(degree, self._degree))

    def kinds(self, degree: int, in_curved: int) -> list[tuple[IntArray, Any, int]]:
        """Cells (C,) in DOLFINx' order, their measure and its degree, of straight cells and of those ``in_curved``
        ones."""
        if self._curved is None:
            count = self._space.mesh.topology.index_map(self._space.numbering.dimension).size_local
            return [(np.arange(count), self._dx(degree=degree), degree)]
        straight, curved = np.flatnonzero(~self._curved), np.flatnonzero(self._curved)
        return [
            (straight, self._dx(_STRAIGHT, degree=degree), degree),
            (curved, self._dx(_CURVED, degree=in_curved), in_curved),
        ]
