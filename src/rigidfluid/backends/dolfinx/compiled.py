"""Forms that DOLFINx compiles for this machine."""

from __future__ import annotations

from typing import Any

from dolfinx import fem

_COMPILER = {"cffi_extra_compile_args": ["-O3", "-march=native"]}


def compiled(form: Any) -> Any:
    """A form, or a table of forms, compiled."""
    return fem.form(form, jit_options=_COMPILER)
