"""Compare the size of an environment with the one that the README gives a default installation.

    python tools/installed_size.py .venv-wheel

Exits with 1 where they differ by more than a twentieth: releases of other packages make up a few per cent.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

README = Path(__file__).resolve().parents[1] / "README.md"
LARGEST_DIFFERENCE = 0.05


def told() -> float:
    """Size that the README gives a default installation [MB]."""
    found = re.search(r"installs into `\.venv` \((\d+) MB", README.read_text(encoding="utf-8"))
    if found is None:
        raise SystemExit("README.md gives no size of `.venv`")
    return float(found[1])


def taken(folder: Path) -> float:
    """Room that the files of a folder take on the disk [MB], links not followed."""
    inodes = {(stat.st_dev, stat.st_ino): stat.st_blocks for path in folder.rglob("*") if (stat := path.lstat())}
    return 512 * sum(inodes.values()) / 2**20


def main() -> int:
    """1 where the README is wrong."""
    expected, found = told(), taken(Path(sys.argv[1]))
    print(f"{found:.0f} MB; the README says {expected:.0f}")
    return int(abs(found / expected - 1.0) > LARGEST_DIFFERENCE)


if __name__ == "__main__":
    sys.exit(main())
