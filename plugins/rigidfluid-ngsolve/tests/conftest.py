"""scikit-fem's integrals in tetrahedra, made exact."""

import pytest
import skfem.quadrature


@pytest.fixture(autouse=True)
def rule_of_degree_5(monkeypatch: pytest.MonkeyPatch) -> None:
    """In tetrahedra scikit-fem's rule of order 5 is exact to degree 4 only, and that of order 6 to degree 5."""
    of_order = skfem.quadrature.get_quadrature

    def exact(cell: object, order: int) -> object:
        return of_order(cell, 6 if order == 5 else order)

    monkeypatch.setattr(skfem.quadrature, "get_quadrature", exact)
