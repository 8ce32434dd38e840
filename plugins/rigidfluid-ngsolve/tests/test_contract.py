"""The backend "ngsolve" against the contract of fluid backends."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from rigidfluid.testing import FluidBackendContract
from rigidfluid_ngsolve import NGSolve


class TestNGSolve(FluidBackendContract):
    backend = NGSolve
    options: ClassVar[Mapping[str, Any]] = {"tolerance": 1e-12}
