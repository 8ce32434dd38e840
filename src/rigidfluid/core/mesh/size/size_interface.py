"""Abstract class of a size field, and what fields ask for when a mesh is made."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import ClassVar

from rigidfluid.core.geometry.answers import rows
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.guarded import gives
from rigidfluid.core.mesh.flow import AtRest, Flow
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.part import SpatialPart


class SizeField(SpatialPart):
    """Longest edges wanted in the fluid, besides those that bodies, gaps and walls ask for: the least of all counts.

    A field is asked for each mesh, at many points and several times. It must depend on its arguments alone, each length
    on its own point, so that a run goes on from a checkpoint to the last bit. The mesher lets edges grow by a third
    from one to the next, also at jumps of a field.

    Parameters
    ----------
    options : PartOptions
        The type's own keys of the ``[[mesh.field]]`` table.
    dimension : int
        2 or 3.
    """

    kind: ClassVar[str] = "size field"

    @abstractmethod
    @gives(rows(lambda _, points, around, flow: points.shape[:1], positive=True))
    def edge_length(self, points: FloatArray, around: FluidDomain, flow: Flow) -> FloatArray:
        """Longest edge wanted at each point [length].

        Parameters
        ----------
        points : (m, d) array
            Points of the fluid or of its boundary [length].
        around : FluidDomain
            The domain without the bodies in their present pose. Its ``width`` asks for nothing: no edge is longer.
        flow : Flow
            Fluid and bodies on the mesh before; at rest when the first mesh is made.

        Returns
        -------
        (m,) array
            Positive and finite lengths [length].
        """


def with_fields(sizes: Sizes, fields: Sequence[SizeField], around: FluidDomain, flow: Flow) -> Sizes:
    """Sizes with what ``fields`` ask for ``around`` the bodies at this moment of the ``flow``."""
    asked = (partial(field.edge_length, around=around, flow=flow) for field in fields)
    return replace(sizes, asked=(*sizes.asked, *asked))


def with_fields_at_rest(sizes: Sizes, fields: Sequence[SizeField], around: FluidDomain) -> Sizes:
    """Sizes with what ``fields`` ask for in the first mesh, in a fluid at rest."""
    return with_fields(sizes, fields, around, AtRest(len(around.bodies), around.domain.dimension))
