"""Way in which the bodies of a scene come into its first mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from rigidfluid.core.model.body import Body
from rigidfluid.core.model.domain import Domain
from rigidfluid.errors import MeshError

MESHER_TIMEOUT = 600.0
"""Seconds after which a mesher that has not ended is stopped."""

Way = Literal["cad", "fill", "level_set"]


@dataclass(frozen=True, slots=True)
class Inserter:
    """Way of making the first mesh, and how long it may take.

    ``way``: "cad", Netgen meshes the difference of CAD shapes, which are made of bodies' facets too where surfaces are
    periodic; "fill", it fills between the facets of domain and bodies; "level_set", MMG cuts bodies out of a mesh of
    the domain. None: "cad" where all have CAD shapes or surfaces are periodic, else "fill". ``timeout``: a mesher that
    fills is stopped after it [s].
    """

    way: Way | None = None
    timeout: float = MESHER_TIMEOUT

    def chosen(self, bodies: Sequence[Body], domain: Domain, field: str = "body") -> Way:
        """The way for these shapes, of the tables ``field``; raises MeshError where one of them has no CAD shape and
        needs it."""
        of_facets = [f"{field}.{i}" for i, body in enumerate(bodies) if body.facets is not None]
        of_facets += ["the domain"] if domain.facets is not None else []
        if domain.periodic:
            if domain.facets is not None or self.way not in ("cad", None):
                found = f"{self.way!r}" if self.way else "the domain made of facets"
                allowed, remedy = "'cad', and a domain that is not made of facets", "Leave the key out."
                raise MeshError("mesh.inserter", f"{found} with periodic surfaces", allowed, remedy)
            return "cad"
        if self.way == "cad" and of_facets:
            found = f"'cad' with {of_facets[0]} made of facets"
            raise MeshError("mesh.inserter", found, "'fill' or 'level_set' for facets", "Leave the key out.")
        return self.way or ("fill" if of_facets else "cad")


BY_SHAPE = Inserter()
"""The way that suits the shapes."""
