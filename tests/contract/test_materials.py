"""Every built-in material satisfies the contract."""

import pytest
from sheared_materials import materials

from rigidfluid.materials.expression import ExpressionMaterial, ExpressionOptions
from rigidfluid.testing import MaterialContract


class TestMaterials(MaterialContract):
    @pytest.fixture(params=list(materials(2)))
    def material(self, request):
        return materials(2)[request.param]


class TestExpression(MaterialContract):
    @pytest.fixture
    def material(self):
        return ExpressionMaterial(ExpressionOptions(viscosity="0.1 + 0.4/(1 + shear_rate)**0.5"), 2)
