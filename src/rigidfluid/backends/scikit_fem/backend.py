"""Fluid backend "scikit-fem": quadrature and basis functions by scikit-fem, loops compiled by numba."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, final

from rigidfluid.core.fluid.material import Material, Newtonian
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.sparse_backend import SparseBackend

if TYPE_CHECKING:
    from rigidfluid.backends.scikit_fem.assembly import CompiledAssembly


@final
class ScikitFem(SparseBackend):
    """Assembled by one core."""

    name: ClassVar[str] = "scikit-fem"
    materials: ClassVar[tuple[type[Material], ...]] = (Newtonian, GeneralisedNewtonian)
    refinements: ClassVar[bool] = True
    duals: ClassVar[bool] = True
    scalars: ClassVar[bool] = True
    conduction: ClassVar[bool] = True
    requires: ClassVar[dict[str, str]] = {"skfem": "scikit-fem", "numba": "numba"}

    def assembly(self, numbering: Numbering) -> CompiledAssembly:
        from rigidfluid.backends.scikit_fem.assembly import CompiledAssembly

        return CompiledAssembly(numbering)

    def scalar_assembly(self, numbering: Numbering) -> CompiledAssembly:
        from rigidfluid.backends.scikit_fem.assembly import CompiledAssembly

        if not (isinstance(self._assembly, CompiledAssembly) and self._assembly.numbering is numbering):
            return self.assembly(numbering)
        return self._assembly
