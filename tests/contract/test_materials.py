"""Every built-in material satisfies the contract."""

import pytest
from sheared_materials import materials

from rigidfluid.testing import MaterialContract


class TestMaterials(MaterialContract):
    @pytest.fixture(params=list(materials(2)))
    def material(self, request):
        return materials(2)[request.param]
