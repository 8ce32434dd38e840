"""Makes a page in a process of its own: by its module in docs/pages, or by the benchmark that measures it."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

from page_tools.places import PAGES, ROOT, generators

PATHS = (ROOT / "src", ROOT / "docs", ROOT / "tests" / "support")
THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")
MEASURED = {
    "backends": "benchmarks/backends.py",
    "contact_step": "benchmarks/contact_step.py",
    "parallel": "benchmarks/parallel_page.py",
    "settling_sphere": "benchmarks/settling_sphere.py",
    "step": "benchmarks/step.py",
    "work_precision": "benchmarks/work_precision.py",
}
"""Pages that tell times, by what measures and writes them."""


def pages() -> list[str]:
    """Names of all pages."""
    return sorted([*generators(), *MEASURED])


def make(name: str, *, fresh: bool = False, present: bool = False, folder: Path | None = None) -> bool:
    """Make one page, in docs/validation or another ``folder``; whether it could be made."""
    if name in MEASURED:
        words = [str(ROOT / MEASURED[name]), "--page", str((folder or PAGES) / f"{name}.md")]
    else:
        words = ["-m", "page_tools", name, *["--fresh"] * fresh, *["--present"] * present]
        words += ["--to", str(folder)] if folder else []
    print(shlex.join(["python", *words]), flush=True)
    path = os.pathsep.join([*map(str, PATHS), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = dict.fromkeys(THREADS, "1") | os.environ | {"PYTHONPATH": path}
    return not subprocess.run([sys.executable, *words], cwd=ROOT, env=environment, check=False).returncode
