"""Joints that a scene names: their classes, and the keys of its tables that are theirs."""

from __future__ import annotations

from collections.abc import Sequence

from rigidfluid.core.joints.joint import Joint
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.nested.part_options import told_at
from rigidfluid.core.nested.strokes import read_stroke_rows
from rigidfluid.core.scene.joint_tables import JointTable
from rigidfluid.core.scene.rows_over_time import StrokeTable
from rigidfluid.core.scene.validation import fields_by_key, read_table, unknown_key
from rigidfluid.core.setup.rigid_body import JoinedBodies
from rigidfluid.registry import JOINT, Registry


def scene_joints(tables: Sequence[JointTable], registry: Registry, dimension: int) -> tuple[JoinedBodies, ...]:
    """Joints of a scene; raises PluginError for a type that is not there, SceneError for options that are unknown or
    contradict each other."""
    return tuple(
        JoinedBodies(table.name, _built(table, registry, dimension, f"joint.{number}"), table.between, table.at)
        for number, table in enumerate(tables)
    )


def read_drives(tables: Sequence[JointTable]) -> tuple[JointTable, ...]:
    """Tables with the rows of all files of drives in their place, so that a checkpoint needs no file; raises as
    `scene_joints` does."""
    if not tables:
        return ()
    registry = Registry.load()
    return tuple(_with_rows(table, registry, f"joint.{number}") for number, table in enumerate(tables))


def _built(table: JointTable, registry: Registry, dimension: int, at: str) -> Joint:
    part = registry.get(JOINT, table.type, f"{at}.type")
    options = _options(table, part, registry, at)
    with told_at(at):
        return part(options, dimension)


def _options(table: JointTable, part: type[Joint], registry: Registry, at: str) -> PartOptions:
    known = fields_by_key(part.Options)
    for key in table.options:
        if key not in known:
            raise unknown_key(f"{at}.{key}", {*known, *type(table).model_fields}, _reader_hint(key, registry))
    return read_table(part.Options, table.options, at)


def _reader_hint(key: str, registry: Registry) -> str:
    """Remedy for a key that joints of other types read; empty where none does."""
    readers = [repr(part.name) for part in registry.installed(JOINT) if key in fields_by_key(part.Options)]
    return f"Set type = {' or '.join(readers)}, or remove `{key}`." if readers else ""


def _with_rows(table: JointTable, registry: Registry, at: str) -> JointTable:
    part = registry.get(JOINT, table.type, f"{at}.type")
    options, keys = _options(table, part, registry, at), fields_by_key(part.Options)
    names = {key: name for name, field in part.Options.model_fields.items() for key in keys if keys[key] is field}
    strokes = {key: getattr(options, names[key]) for key in table.options}
    rows = {
        key: read_stroke_rows(stroke, f"{at}.{key}").model_dump(mode="json", exclude_none=True)
        for key, stroke in strokes.items()
        if isinstance(stroke, StrokeTable)
    }
    return table.model_copy(update=rows)
