"""Makes one page: python -m page_tools NAME [--fresh] [--present] [--to FOLDER [--kept]], with docs and tests/support
on PYTHONPATH; to another folder, its runs are kept there too, unless those of the repository are ``--kept``."""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

from page_tools.page import write
from page_tools.places import MEASURED, PAGES, RUNS
from page_tools.work import Work


def main(*words: str) -> None:
    """Make it from its runs, which are made where they are not kept."""
    parser = argparse.ArgumentParser()
    parser.add_argument("name")
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--present", action="store_true")
    parser.add_argument("--to", type=Path)
    parser.add_argument("--kept", action="store_true")
    given = parser.parse_args(words or None)
    folder = given.to or PAGES
    runs, measured = (given.to / "runs", given.to / MEASURED.name) if given.to and not given.kept else (RUNS, MEASURED)
    work = Work(given.name, fresh=given.fresh, present=given.present, runs=runs, measured=measured)
    page = import_module(f"pages.{given.name}").page(work)
    folder.mkdir(parents=True, exist_ok=True)
    write(page, given.name, work, folder)


if __name__ == "__main__":
    main()
