"""Forms that DOLFINx compiles for this machine."""

from __future__ import annotations

from typing import Any

from dolfinx import fem

# Of several processes that need a form at once, one compiles it and the others wait. A form of curved cells in 3D takes
# longer than the 10 s that DOLFINx waits for unless told.
_COMPILER = {"cffi_extra_compile_args": ["-O3", "-march=native"], "timeout": 300}


def compiled(form: Any) -> Any:
    """A form, or a table of forms, compiled."""
    return fem.form(form, jit_options=_COMPILER)
