"""Makes a page in a process of its own: by its module in docs/pages, or by the benchmark that measures it."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from page_tools.places import PAGES, ROOT, generators
from page_tools.provenance import COMMIT, commit
from rigidfluid.python_process import ONE_THREAD

CORES = 2
PATHS = (ROOT / "src", ROOT / "docs", ROOT / "tests" / "support")
MEASURED = {
    "backends": "benchmarks/backends.py",
    "contact_step": "benchmarks/contact_step.py",
    "parallel": "benchmarks/parallel_page.py",
    "settling_sphere": "benchmarks/settling_sphere.py",
    "step": "benchmarks/step.py",
    "step_profile": "benchmarks/step_profile.py",
    "work_precision": "benchmarks/work_precision.py",
}
"""Pages that tell times, by what measures and writes them."""

TESTS = "tests"
"""The page of the validation tests."""

WITH_DOLFINX = ("backends", "backends_study", "parallel", "settling_sphere", "ten_cate")
"""Pages that need DOLFINx."""


def pages() -> list[str]:
    """Names of all pages."""
    return sorted([*generators(), *MEASURED])


def make(
    name: str, *, fresh: bool = False, present: bool = False, folder: Path | None = None, kept: bool = False
) -> bool:
    """Make one page, in docs/validation or another ``folder``, where its runs are too unless those that are ``kept``
    serve; whether it could be made."""
    if name in MEASURED:
        words = [str(ROOT / MEASURED[name]), "--page", str((folder or PAGES) / f"{name}.md")]
    else:
        words = ["-m", "page_tools", name, *["--fresh"] * fresh, *["--present"] * present]
        words += ["--to", str(folder)] if folder else []
        words += ["--kept"] * kept
    command = [*_python(name), *words]
    print(shlex.join(command), flush=True)
    path = os.pathsep.join([*map(str, PATHS), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = ONE_THREAD | os.environ | {"PYTHONPATH": path, COMMIT: commit()}
    return not subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode


def make_several(names: list[str], **how: Any) -> dict[str, bool]:
    """Make pages, two at a time, then that of the tests, which take up the runs of others, and those that tell times,
    each alone; whether each could be made.

    Where this is interrupted no other page is begun.
    """
    shared = [name for name in names if name != TESTS and name not in MEASURED]
    alone = sorted((name for name in names if name not in shared), key=MEASURED.__contains__)
    pool = ThreadPoolExecutor(CORES)
    try:
        made = dict(zip(shared, pool.map(partial(make, **how), shared), strict=True))
    finally:
        pool.shutdown(cancel_futures=True)
    return made | {name: make(name, **how) for name in alone}


def _python(name: str) -> list[str]:
    """This Python; or that of the folder with DOLFINx, of a page that needs it where there is none."""
    if name in WITH_DOLFINX and find_spec("dolfinx") is None:
        return ["tools/dolfinx", "run", "python3"]
    return [sys.executable]
