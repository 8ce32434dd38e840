"""Write the table of THIRD_PARTY.md: the packages of requirements.lock, what their metadata call their licence, and
which of rigidfluid, its extras and its plug-ins bring them.

    .venv/bin/python tools/third_party.py
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[1]
PAGE, LOCK = ROOT / "THIRD_PARTY.md", ROOT / "requirements.lock"
PLUGINS = sorted(path.name for path in (ROOT / "plugins").iterdir())
HEADER = "| package | licence | comes with |\n|---|---|---|\n"
_LONG = 60


def required(package: str, extra: str = "") -> Iterator[tuple[str, str]]:
    """Names of packages, with an extra of theirs or none, that a package's extra asks for on this machine; those
    that it always asks for without one."""
    for wanted in map(Requirement, metadata.requires(package) or ()):
        of_extra = wanted.marker is not None and "extra" in str(wanted.marker)
        if of_extra == bool(extra) and (wanted.marker is None or wanted.marker.evaluate({"extra": extra})):
            yield from ((canonicalize_name(wanted.name), more) for more in ("", *sorted(wanted.extras)))


def brought(package: str, extra: str = "") -> set[str]:
    """Names of all packages that come with one, or with an extra of it."""
    found, open_ = set(), [(package, extra)]
    while open_:
        following = {one for one in required(*open_.pop()) if one not in found}
        found |= following
        open_ += following
    return {name for name, _ in found}


def licence(package: str) -> str:
    """Licence of a package in its metadata's shortest words."""
    about = metadata.metadata(package)
    for text in (about.get("License-Expression"), about.get("License")):
        if text and text != "UNKNOWN" and len(text) < _LONG and "\n" not in text:
            return text
    classifiers = [text for text in about.get_all("Classifier") or () if text.startswith("License ::")]
    return ", ".join(text.rpartition(" :: ")[2] for text in classifiers) or "not stated"


def table() -> str:
    """Rows of all packages of the lock file."""
    extras = metadata.metadata("rigidfluid").get_all("Provides-Extra") or []
    always = brought("rigidfluid")
    others = {f"[{extra}]": brought("rigidfluid", extra) - always for extra in extras}
    others |= {plugin: brought(plugin) - always for plugin in PLUGINS}
    rows = []
    for package, version in re.findall(r"^([\w.-]+)==(\S+)$", LOCK.read_text(encoding="utf-8"), re.MULTILINE):
        name = canonicalize_name(package)
        with_ = ["rigidfluid"] if name in always else [other for other, names in others.items() if name in names]
        rows.append(f"| {package} {version} | {licence(package)} | {', '.join(with_)} |\n")
    return HEADER + "".join(rows)


def main() -> int:
    """0 when the table is written."""
    text = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(text.partition(HEADER)[0] + table(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
