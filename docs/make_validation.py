"""Makes the pages of docs/validation from runs that are kept in out/validation, and says which are out of date.

python docs/make_validation.py [NAME ...] [--fresh]     makes these pages, or all; --fresh runs anew what is kept
python docs/make_validation.py --stale                  names those that are older than what they were made from

A page is made by docs/pages/NAME.py, in a process and with one thread of its own. A run that was stopped goes on. Pages
that fail are named at the end, and stay as they were.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys

from page_tools.places import ROOT, generators
from page_tools.stale import stale

PATHS = (ROOT / "src", ROOT / "docs", ROOT / "tests" / "support")


def make(name: str, fresh: bool) -> bool:
    """Make one page; whether it could be made."""
    path = os.pathsep.join([*map(str, PATHS), *filter(None, [os.environ.get("PYTHONPATH")])])
    threads = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
    command = [sys.executable, "-m", "page_tools", name, *["--fresh"] * fresh]
    return not subprocess.run(command, env=threads | os.environ | {"PYTHONPATH": path}, check=False).returncode


def main() -> int:
    """0 where all pages that were asked for could be made, or none is stale."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(generators()))
    parser.add_argument("--fresh", action="store_true", help="run anew what is kept")
    parser.add_argument(
        "--stale", action="store_true", help="name the pages that are out of date, and what has changed"
    )
    given = parser.parse_args()
    if unknown := set(given.names) - set(generators()):
        parser.error(f"no page {', '.join(sorted(unknown))}; there are {', '.join(generators())}")
    if given.stale:
        found = dict(stale())
        for name, why in found.items():
            print(f"{name}: {why}")
        return int(bool(found))
    failed = [name for name in given.names or generators() if not make(name, given.fresh)]
    if failed:
        print(f"could not be made: {', '.join(failed)}")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
