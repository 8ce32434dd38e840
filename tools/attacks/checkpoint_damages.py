"""Damage to the folder of a run that is to be taken up: its checkpoint, its tables, and files that changed places."""

from __future__ import annotations

import functools
import io
import os
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.random import Generator

from attacks.damages import DAMAGES, cut_off, no_bytes, one_bit, some_bytes, words
from attacks.small_runs import TABLES
from rigidfluid.core.output.sealed_file import seal

STATE = "state.h5"
_OTHERS = ("summary.json", "fields.pvd", "run.lock", "fields/000000.vtu")


@dataclass(frozen=True)
class Folders:
    """The run's folder ``to_break``, and others to take files from: of the same run ``earlier`` and ``later``, and of
    an ``other`` scene."""

    to_break: Path
    earlier: Path
    later: Path
    other: Path


Harm = Callable[[Folders, Generator], str]
"""Damages a folder, and says how."""

Edit = Callable[[h5py.File, str], object]
"""Changes what has a name in a file."""


def damage_bytes(folders: Folders, random: Generator, group: str) -> str:
    """Damage of one group to the checkpoint's bytes."""
    kinds = DAMAGES[group]
    kind = kinds[int(random.integers(0, len(kinds)))]
    _rewrite(folders.to_break / STATE, lambda data: kind(data, random))
    return kind.__name__


def edit_checkpoint(folders: Folders, random: Generator) -> str:
    """Change something in the checkpoint by h5py."""
    with h5py.File(folders.to_break / STATE, "r+") as file:
        return _edited(file, random, _EDITS)


def edit_and_seal(folders: Folders, random: Generator) -> str:
    """Make of the checkpoint what no run writes, and renew its digest."""
    path = folders.to_break / STATE
    image = io.BytesIO(path.read_bytes())
    with h5py.File(image, "r+") as file:
        said = _edited(file, random, _TELLING_EDITS)
    seal(image)
    path.write_bytes(image.getbuffer())
    return said


def change_a_table(folders: Folders, random: Generator) -> str:
    """Change, cut, remove or replace one table of the run."""
    name = TABLES[int(random.integers(0, len(TABLES)))]
    change = list(_CHANGES)[int(random.integers(0, len(_CHANGES)))]
    _CHANGES[change](folders.to_break / name, random)
    return f"{name}: {change}"


def change_another_file(folders: Folders, random: Generator) -> str:
    """Change or remove what lies beside tables and checkpoint."""
    names = [name for name in _OTHERS if (folders.to_break / name).exists()]
    name = names[int(random.integers(0, len(names)))]
    path, kind = folders.to_break / name, (no_bytes, words, cut_off, some_bytes, None)[int(random.integers(0, 5))]
    if kind is None or not path.stat().st_size:
        path.unlink()
        return f"{name}: removed"
    _rewrite(path, lambda data: kind(data, random))
    return f"{name}: {kind.__name__}"


def swap_files(folders: Folders, random: Generator) -> str:
    """Put a file in the place of another, from this run, an earlier or later time of it, or another scene's run."""
    source = ("earlier", "later", "other", "to_break")[int(random.integers(0, 4))]
    pair = random.permutation([STATE, *TABLES])[:2].tolist() if source == "to_break" else [_any_name(random)] * 2
    shutil.copyfile(getattr(folders, source) / pair[0], folders.to_break / pair[1])
    return f"{pair[0]} of {source} as {pair[1]}"


HARMS: Mapping[str, Harm] = {
    **{f"state.h5: {group}": functools.partial(damage_bytes, group=group) for group in DAMAGES},
    "state.h5: edited by h5py": edit_checkpoint,
    "state.h5: edited, its digest renewed": edit_and_seal,
    "tables: edited, cut, removed": change_a_table,
    "files that changed places": swap_files,
    "summary, list of fields, lock": change_another_file,
}
"""Kinds of damage to a run's folder, by the words of a table."""


def _edited(file: h5py.File, random: Generator, edits: Sequence[Edit]) -> str:
    """Make one of the edits somewhere in a file, and say which."""
    names: list[str] = []
    file.visit(names.append)
    name = names[int(random.integers(0, len(names)))]
    edit = edits[int(random.integers(0, len(edits)))]
    edit(file, name)
    return f"{edit.__name__} {name}"


def _any_name(random: Generator) -> str:
    names = [STATE, STATE, *TABLES]
    return names[int(random.integers(0, len(names)))]


def _rewrite(path: Path, change: Callable[[bytes], bytes]) -> None:
    path.write_bytes(change(path.read_bytes()))


def _add_a_line(path: Path, random: Generator) -> None:
    lines = path.read_bytes().splitlines(keepends=True)
    place = int(random.integers(0, len(lines)))
    path.write_bytes(b"".join([*lines[:place], lines[-1], *lines[place:]]))


def _next_digit(path: Path, random: Generator) -> None:
    data = bytearray(path.read_bytes())
    places = [i for i, byte in enumerate(data) if 48 <= byte < 57] or [0]
    data[places[int(random.integers(0, len(places)))]] += 1
    path.write_bytes(data)


def _make_a_pipe(path: Path, random: Generator) -> None:
    path.unlink()
    os.mkfifo(path)


def _make_a_folder(path: Path, random: Generator) -> None:
    path.unlink()
    path.mkdir()


def _make_a_link(path: Path, random: Generator) -> None:
    path.rename(path.with_name("elsewhere"))
    path.symlink_to(path.with_name("elsewhere"))


_CHANGES: Mapping[str, Callable[[Path, Generator], object]] = {
    "a bit": lambda path, random: _rewrite(path, lambda data: one_bit(data, random)),
    "a digit": _next_digit,
    "a line more": _add_a_line,
    "cut off": lambda path, random: _rewrite(path, lambda data: cut_off(data, random)),
    "empty": lambda path, random: path.write_bytes(b""),
    "removed": lambda path, random: path.unlink(),
    "lines that end as on Windows": lambda path, random: _rewrite(path, lambda data: data.replace(b"\n", b"\r\n")),
    "words at its end": lambda path, random: _rewrite(path, lambda data: data + b"a line of a run that was killed"),
    "a pipe": _make_a_pipe,
    "a folder": _make_a_folder,
    "a link": _make_a_link,
}


def _set_to_next_value(file: h5py.File, name: str) -> None:
    if isinstance(file[name], h5py.Dataset) and file[name].dtype.kind in "fiu" and file[name].size:
        value: Any = np.asarray(file[name][()])
        file[name][...] = np.nextafter(value, np.inf) if value.dtype.kind == "f" else value + 1
    else:
        _remove(file, name)


def _set_to_nan(file: h5py.File, name: str) -> None:
    if isinstance(file[name], h5py.Dataset) and file[name].dtype.kind == "f" and file[name].size:
        file[name][...] = np.nan
    else:
        _remove(file, name)


def _set_below_zero(file: h5py.File, name: str) -> None:
    if isinstance(file[name], h5py.Dataset) and file[name].dtype.kind == "i" and file[name].size:
        file[name][...] = -5
    else:
        _remove(file, name)


def _remove(file: h5py.File, name: str) -> None:
    del file[name]


def _reshape(file: h5py.File, name: str) -> None:
    del file[name]
    file[name] = np.zeros((3, 1, 2))


def _make_text(file: h5py.File, name: str) -> None:
    del file[name]
    file[name] = "a text"


def _make_huge(file: h5py.File, name: str) -> None:
    del file[name]
    file.create_dataset(name, shape=(1 << 40,), dtype="f8", chunks=(1 << 20,))


def _store_elsewhere(file: h5py.File, name: str) -> None:
    del file[name]
    file.create_dataset(name, (2, 2), "f8", external=[("/dev/zero", 0, 32)])


def _make_complex(file: h5py.File, name: str) -> None:
    del file[name]
    file[name] = np.zeros(3, dtype=complex)


def _link_outwards(file: h5py.File, name: str) -> None:
    del file[name]
    file[name] = h5py.ExternalLink("elsewhere.h5", name)


def _link_to_itself(file: h5py.File, name: str) -> None:
    del file[name]
    file[name] = h5py.SoftLink(f"/{name}")


def _add(file: h5py.File, name: str) -> None:
    file[f"{name}_more"] = 1.0


def _another_format(file: h5py.File, name: str) -> None:
    file.attrs["format"] = int(file.attrs["format"]) + 1


_TELLING_EDITS = (
    _set_to_nan,
    _set_below_zero,
    _remove,
    _reshape,
    _make_text,
    _make_huge,
    _link_outwards,
    _link_to_itself,
    _store_elsewhere,
    _make_complex,
    _another_format,
)
"""Edits that leave what no run writes."""

_EDITS = (*_TELLING_EDITS, _set_to_next_value, _add)
