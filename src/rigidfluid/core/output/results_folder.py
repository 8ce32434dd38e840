"""Folders of results: one process at a time writes there, and nothing is replaced or removed that is not a result.

A product is what a command writes. Its mark, a file that is locked while it is written, says that a folder is its own.
"""

from __future__ import annotations

import os
import re
import stat
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, TextIO

from rigidfluid.core.output.disk import writing
from rigidfluid.errors import OutputError

_KINDS = {stat.S_IFLNK: "a link", stat.S_IFDIR: "a folder", stat.S_IFREG: "a file", stat.S_IFIFO: "a pipe"}
"""Kinds of things in a folder; all others are devices."""


@dataclass(frozen=True)
class Product:
    """Files that a command writes to a folder: ``kind``, one word, as "run", and the ``pattern`` of their paths there,
    some of them in ``subfolders``."""

    kind: str
    pattern: str
    subfolders: tuple[str, ...] = ()

    @property
    def mark(self) -> str:
        """Name of the file that marks its folder."""
        return f"{self.kind}.lock"

    def present(self, out: Path) -> Iterator[Path]:
        """Its files in a folder, by their names."""
        for folder in (out, *(out / name for name in self.subfolders)):
            files = sorted(folder.iterdir()) if folder.is_dir() else []
            yield from (file for file in files if re.fullmatch(self.pattern, file.relative_to(out).as_posix()))


def take_folder(out: Path, product: Product, *, new: bool) -> TextIO:
    """Lock a folder for a product until what is returned is closed or this process ends, however it ends.

    The folder is made if there is none. Raises OutputError where another process is writing there, a link or a device
    lies where a file is to be written, the disk refuses, or, if the product is ``new``, files there are not known
    to be its own.
    """
    with writing(out):
        refuse_links(out, product)
        is_marked = _is_marked(out, product)
        if new and not is_marked:
            _refuse_foreign(out, product)
        out.mkdir(parents=True, exist_ok=True)
        return _locked(out, product)


def join_folder(out: Path, product: Product, added: Product) -> None:
    """Make a folder, in which a product was found, one to which files of ``added`` are written.

    Raises OutputError where a link or a device lies where a file is to be written, or the folder has no mark and files
    are there already in the place of the added ones; else it is marked.
    """
    with writing(out):
        refuse_links(out, product)
        if not _is_marked(out, product):
            _refuse_foreign(out, added)
            _locked(out, product).close()


def is_being_written(out: Path, product: Product) -> bool:
    """Tell whether a process is writing the product to a folder now; False also where there are no locks."""
    if not (out / product.mark).is_file():
        return False
    with (out / product.mark).open("rb") as file:
        return not _lock(file)


def refuse_links(out: Path, product: Product) -> None:
    """Raise OutputError where a link, a device or a folder lies in the place of a file, or a link in that of a
    subfolder: what it leads to is not this product's."""
    folders = dict.fromkeys((out / name for name in product.subfolders), stat.S_IFDIR)
    files = dict.fromkeys((out / product.mark, *product.present(out)), stat.S_IFREG)
    for path, wanted in (folders | files).items():
        found = stat.S_IFMT(path.lstat().st_mode) if os.path.lexists(path) else wanted
        if found != wanted:
            allowed, remedy = f"{_KINDS[wanted]}, or nothing", "Choose another --out, or move it away."
            raise OutputError(str(path), _KINDS.get(found, "a device"), allowed, remedy)


def clear(out: Path, product: Product) -> None:
    """Remove earlier files, so that two runs never mix."""
    for file in list(product.present(out)):
        file.unlink()


def _is_marked(out: Path, product: Product) -> bool:
    """Tell whether the folder has the product's mark; raises OutputError for another file of that name."""
    mark = out / product.mark
    if not mark.exists():
        return False
    with mark.open("rb") as file:
        if file.read(100).endswith(_signature(product).encode()):
            return True
    raise OutputError(
        str(mark),
        f"a file that no {product.kind} has written",
        f"the mark of a {product.kind}'s folder, or no such file",
        "Choose another --out, or move it away.",
    )


def _refuse_foreign(out: Path, product: Product) -> None:
    """Raise OutputError where files would be replaced or removed in a folder that is not the product's."""
    foreign = next(product.present(out), None)
    if foreign is not None:
        raise OutputError(
            str(foreign),
            f"a file of this name in a folder that is of no {product.kind}, as it has no {product.mark}",
            f"a new or empty folder, or one that an earlier {product.kind} has written",
            "Choose another --out, or move the files away.",
        )


def _locked(out: Path, product: Product) -> TextIO:
    file = os.fdopen(os.open(out / product.mark, os.O_RDWR | os.O_CREAT, 0o666), "r+", encoding="ascii")
    if not _lock(file):
        found = f"a {product.kind} in progress, of process {file.read().partition(' ')[0] or 'unknown'}"
        file.close()
        allowed = f"a folder that no {product.kind} is writing to"
        raise OutputError(str(out), found, allowed, "Wait for it, or choose another --out.")
    file.write(f"{os.getpid():<10} {_signature(product)}")  # as long as an earlier one, so that none is left torn
    file.flush()
    return file


def _signature(product: Product) -> str:
    return f"writes this {product.kind} of rigidfluid\n"


def _lock(file: IO[Any]) -> bool:
    """Tell whether nobody else holds it; true also where no such locks exist: on Windows, and on some network disks."""
    if sys.platform == "win32":
        return True
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True
