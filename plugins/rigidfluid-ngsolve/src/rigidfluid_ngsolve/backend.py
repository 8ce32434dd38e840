"""The fluid backend "ngsolve"."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar, final

from rigidfluid.api import GeneralisedNewtonian, Material, Newtonian
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.sparse_backend import SparseBackend

if TYPE_CHECKING:
    from rigidfluid_ngsolve.assembly import FormAssembly


@final
class NGSolve(SparseBackend):
    """The step of `rigidfluid.taylor_hood`, its integrals written as NGSolve's forms."""

    name: ClassVar[str] = "ngsolve"
    materials: ClassVar[tuple[type[Material], ...]] = (Newtonian, GeneralisedNewtonian)
    requires: ClassVar[Mapping[str, str]] = {"ngsolve": "ngsolve (`pip install ngsolve`)"}

    def assembly(self, numbering: Numbering) -> FormAssembly:
        from rigidfluid_ngsolve.assembly import FormAssembly

        return FormAssembly(numbering, convection=self.problem.inertia)
