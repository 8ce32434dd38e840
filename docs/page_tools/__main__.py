"""Makes one page: python -m page_tools NAME [--fresh], with docs and tests/support on PYTHONPATH."""

from __future__ import annotations

import sys
from importlib import import_module

from page_tools.page import write, write_inputs
from page_tools.work import Work


def main(name: str, *options: str) -> None:
    """Make it from its runs, which are made where they are not kept."""
    generator = import_module(f"pages.{name}")
    work = Work(name, fresh="--fresh" in options)
    write(generator.page(work), name, work.outdated)
    write_inputs(name, work.inputs)


if __name__ == "__main__":
    main(*sys.argv[1:])
