"""Makes the pages of docs/validation from runs that are kept in out/validation, and says which are out of date.

python docs/make_validation.py [NAME ...] [--fresh]     makes these pages, or all; --fresh runs anew what is kept, also
                                                        rows in docs/validation/measured
python docs/make_validation.py --present [NAME ...]     the same, but for pages that the present sources have made; runs
                                                        of other sources are run again; what was stopped goes on
python docs/make_validation.py --check [NAME ...]       makes quick pages anew in out/pages, and names those that
                                                        say something else than docs/validation
python docs/make_validation.py --stale [NAME ...]       names those that are edited, or whose first steps are others now

A page is made by docs/pages/NAME.py, or measured by benchmarks/NAME.py, in a process and with one thread of its own,
two at a time. A run that was stopped goes on. Pages that fail are named at the end, and stay as they were.
"""

from __future__ import annotations

import argparse
import sys

from page_tools.check import check
from page_tools.make import make_several, pages
from page_tools.quick import quick
from page_tools.record import read_record
from page_tools.stale import stale, steps_again, unseen


def make_all(names: list[str], fresh: bool, present: bool) -> int:
    """Make pages; 1 where some could not be made."""
    wanted = [name for name in names if not (present and _is_present(name))]
    failed = [name for name, well in make_several(wanted, fresh=fresh, present=present).items() if not well]
    if failed:
        print(f"could not be made: {', '.join(failed)}")
    return int(bool(failed))


def _is_present(name: str) -> bool:
    record = read_record(name)
    return record is not None and record.is_present


def check_all(names: list[str]) -> int:
    """Make quick pages anew elsewhere, and say what they say else; 1 where some do."""
    found = dict(check(names))
    for name, lines in found.items():
        print(f"{name}: {'the same' if not lines else f'{len(lines)} lines differ'}", *lines, sep="\n")
    return int(any(found.values()))


def tell_stale(names: list[str]) -> int:
    """Name what is out of date, and what cannot be told; 1 where something is out of date."""
    found = dict(stale(names, steps_again))
    for name, why in found.items():
        print(f"{name}: {why}")
    for name, how in unseen(names):
        if name not in found:
            print(f"{name}: {how}; of its results nothing is recorded")
    return int(bool(found))


def main() -> int:
    """0 where all pages that were asked for could be made, say the same, or are not stale."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(pages()))
    parser.add_argument("--fresh", action="store_true", help="run anew what is kept")
    way = parser.add_mutually_exclusive_group()
    way.add_argument("--present", action="store_true", help="make what the present sources have not made")
    way.add_argument("--check", action="store_true", help="make quick pages anew, and compare them")
    way.add_argument("--stale", action="store_true", help="name the pages that are out of date")
    given = parser.parse_args()
    if unknown := set(given.names) - set(pages()):
        parser.error(f"no page {', '.join(sorted(unknown))}; there are {', '.join(pages())}")
    if given.check:
        return check_all(given.names or quick())
    if given.stale:
        return tell_stale(given.names or pages())
    return make_all(given.names or pages(), given.fresh, given.present)


if __name__ == "__main__":
    sys.exit(main())
