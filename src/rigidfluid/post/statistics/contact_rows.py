"""Rows of the table of contacts in the states of samples, and the stress of forces there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.suspension import contact_stress
from rigidfluid.post.statistics.samples import Samples


class ContactRows(NamedTuple):
    """Contacts in their ``state`` (c,) of the samples: ``names`` of both surfaces, (c,) each; the numbers ``a`` and
    ``b`` (c,) of bodies that move, -1 of others; the ``columns`` of the table (c,)."""

    samples: Samples
    state: IntArray
    names: tuple[NDArray[Any], NDArray[Any]]
    a: IntArray
    b: IntArray
    columns: Mapping[str, NDArray[Any]]

    @property
    def paired(self) -> BoolArray:
        """Tell which contacts are between bodies that move (c,)."""
        return (self.a >= 0) & (self.b >= 0)

    def vectors(self, kind: str) -> FloatArray:
        """Vectors (c, d) whose columns begin with this letter."""
        axes = "xyz"[: self.samples.dimension]
        return np.stack([self.columns[kind + axis] for axis in axes], axis=1).reshape(-1, len(axes))

    def selected(self, chosen: BoolArray) -> ContactRows:
        """The rows that are ``chosen`` (c,)."""
        names, columns = (self.names[0][chosen], self.names[1][chosen]), self.columns.items()
        kept = {name: values[chosen] for name, values in columns}
        return ContactRows(self.samples, self.state[chosen], names, self.a[chosen], self.b[chosen], kept)

    def shifts(self) -> FloatArray:
        """Displacements of b's image at each contact between bodies from b itself (c, d) [length]."""
        return self.samples.periods(self.vectors("b") - self.samples.position[self.state, self.b])

    def stress(self, force: FloatArray) -> FloatArray:
        """Stress -Σ F (x_a - x_b)ᵀ/V of a ``force`` (c, d) on a of each contact between bodies, in each state (s, d, d)
        [force/length^(d-1)]."""
        position, volume = self.samples.position, self.samples.volume
        arm = position[self.state, self.a] - position[self.state, self.b] - self.shifts()
        states = [self.state == state for state in range(len(self.samples.step))]
        return np.array([contact_stress(force[here], arm[here], volume) for here in states])


def contact_rows(samples: Samples, table: Mapping[str, NDArray[Any]]) -> ContactRows:
    """Rows of the ``table`` of contacts in the states of the samples."""
    places = {name: place for place, name in enumerate(samples.name)}
    states = np.searchsorted(samples.step, table["step"])
    known = states < len(samples.step)
    known[known] = samples.step[states[known]] == table["step"][known]
    columns = {name: values[known] for name, values in table.items()}
    a, b = (np.array([places.get(name, -1) for name in columns[side]], dtype=int) for side in "ab")
    return ContactRows(samples, states[known], (columns["a"], columns["b"]), a, b, columns)
