"""Records as groups of an HDF5 file, their arrays and numbers as its datasets, and what is absent as an empty one.

Nothing is read that is not in the file itself, whole, and of the type that the record wants.
"""

from __future__ import annotations

import types
import typing
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import h5py
import numpy as np

from rigidfluid.core.model.ranks import Ranks

_SCALARS = {int: "iu", float: "fiu", bool: "b"}
_ANY = "fiub"
"""Kinds of numbers, as NumPy names them, in a dataset of one number, and in an array of a backend's."""

_NAMES = {"f": "numbers of 64 bits", "iu": "whole numbers", "b": "truth values", "fiu": "numbers", _ANY: "numbers"}


class Misfit(Exception):
    """Something stored that no record has: its ``name`` in the file, what was ``found`` and what is ``allowed``."""

    def __init__(self, name: str, found: str, allowed: str) -> None:
        super().__init__(name)
        self.name, self.found, self.allowed = name, found, allowed


def store(group: h5py.Group, record: Any) -> None:
    """Write a record, or a mapping of such, of numbers or of arrays, into a ``group``; ranks are left out."""
    names = record if isinstance(record, Mapping) else [field.name for field in fields(record)]
    for name in names:
        value = record[name] if isinstance(record, Mapping) else getattr(record, name)
        if is_dataclass(value) or isinstance(value, Mapping):
            store(group.create_group(name), value)
        elif not isinstance(value, Ranks):
            group.create_dataset(name, data=h5py.Empty("f8") if value is None else value)


def load(group: h5py.Group, kind: Any, ranks: Ranks) -> Any:
    """Read a record of a ``kind`` back, with these ``ranks``; raises Misfit."""
    hints = typing.get_type_hints(kind)
    return kind(**{key: ranks if hint is Ranks else load_value(group, key, hint, ranks) for key, hint in hints.items()})


def load_value(group: h5py.Group, name: str, hint: Any, ranks: Ranks) -> Any:
    """Read what has a ``name`` in a group, or in groups there, as a value of the type ``hint``; raises Misfit."""
    *groups, name = name.split("/")
    for each in groups:
        group = _require_group(_item(group, each))
    stored, origin = _item(group, name), typing.get_origin(hint)
    if origin in (typing.Union, types.UnionType):
        if isinstance(stored, h5py.Dataset) and stored.shape is None:
            return None
        return load_value(group, name, next(one for one in typing.get_args(hint) if one is not type(None)), ranks)
    if is_dataclass(hint) or (isinstance(origin, type) and issubclass(origin, Mapping)):
        inner = _require_group(stored)
        return load(inner, hint, ranks) if origin is None else _mapping(inner, typing.get_args(hint)[1], ranks)
    return _text(_require_dataset(stored)) if hint is str else _numbers(_require_dataset(stored), hint)


def _mapping(stored: h5py.Group, hint: Any, ranks: Ranks) -> dict[str, Any]:
    """A mapping of names to values of one type; arrays are a backend's, of any numbers."""
    if typing.get_origin(hint) is np.ndarray:
        return {name: _array(_require_dataset(_item(stored, name)), _ANY) for name in stored}
    return {name: load_value(stored, name, hint, ranks) for name in stored}


def _name(item: h5py.HLObject) -> str:
    return str(item.name).removeprefix("/")


def _item(group: h5py.Group, name: str) -> h5py.HLObject:
    """The dataset or group of this name in a group, which lies in its own file."""
    link = group.get(name, getlink=True)
    if not isinstance(link, h5py.HardLink):
        found = "nothing" if link is None else "a link to elsewhere"
        raise Misfit(f"{_name(group)}/{name}".removeprefix("/"), found, "what a run has stored there")
    return group[name]


def _require_group(stored: h5py.HLObject) -> h5py.Group:
    if not isinstance(stored, h5py.Group):
        raise Misfit(_name(stored), "a dataset", "a group")
    return stored


def _require_dataset(stored: h5py.HLObject) -> h5py.Dataset:
    if not isinstance(stored, h5py.Dataset):
        raise Misfit(_name(stored), "a group", "a dataset")
    return stored


def _text(stored: h5py.Dataset) -> str:
    if stored.shape != () or h5py.check_string_dtype(stored.dtype) is None:
        raise Misfit(_name(stored), _description(stored), "a text")
    return str(stored.asstr()[()])


def _numbers(stored: h5py.Dataset, hint: Any) -> Any:
    """A number, a tuple of numbers or an array."""
    if hint in _SCALARS:
        return hint(_array(stored, _SCALARS[hint], 0).item())
    if typing.get_origin(hint) is tuple:
        return tuple(_array(stored, "f", 1).tolist())
    kind = np.dtype(typing.get_args(typing.get_args(hint)[1])[0]).kind
    return _array(stored, "iu" if kind == "i" else kind)


def _array(stored: h5py.Dataset, kinds: str, axes: int | None = None) -> Any:
    """The array in a dataset, of numbers of these ``kinds`` and with so many ``axes`` if they are given."""
    is_right = stored.dtype.kind in kinds and (kinds != "f" or stored.dtype.itemsize == 8)
    if not is_right or stored.shape is None or axes not in (None, stored.ndim):
        allowed = {None: "an array of", 0: "one of", 1: "a row of"}[axes]
        raise Misfit(_name(stored), _description(stored), f"{allowed} {_NAMES[kinds]}")
    if stored.is_virtual or stored.external or stored.chunks or stored.id.get_storage_size() != stored.nbytes:
        raise Misfit(_name(stored), "values that are not in the file", "all of them, stored there in one piece")
    return np.asarray(stored[()])


def _description(stored: h5py.Dataset) -> str:
    if stored.shape is None:
        return "nothing"
    return f"{stored.dtype} of shape {stored.shape}"
