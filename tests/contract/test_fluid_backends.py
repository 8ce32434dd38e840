from typing import ClassVar

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.testing import FluidBackendContract


class TestScikitFem(FluidBackendContract):
    backend = ScikitFem
    options: ClassVar = {"tolerance": 1e-12}
