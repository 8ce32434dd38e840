"""Subject of a study that runs a scene."""

from __future__ import annotations

import json
from collections.abc import Callable
from copy import deepcopy
from typing import Any

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.run.run import simulate
from rigidfluid.core.scene.overrides import assign
from rigidfluid.core.scene.places import told_in_file, told_where_set
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.scene.toml_file import read_toml
from rigidfluid.errors import RigidfluidError
from rigidfluid.post.reports.units import Units
from rigidfluid.post.studies.figure import check_figure, read_figure
from rigidfluid.post.studies.model import ErrorTable, Study
from rigidfluid.post.studies.quantities import figure_unit, key_unit
from rigidfluid.post.studies.slope import read_slope
from rigidfluid.post.studies.strict_table import Settings
from rigidfluid.post.studies.subject import Outcome, Target


class SceneSubject:
    """Runs of the study's scene, kept in memory; the scene file is read once.

    Raises SceneError if the scene cannot be read or has no such figure, and the first error if no setting is valid.
    """

    def __init__(self, study: Study) -> None:
        assert study.scene is not None
        assert study.tables.error is not None
        self._fixed = study.tables.set
        self._figure = study.tables.error.figure
        self._parameters = study.parameters
        self._clock = study.tables.study.timed_by
        self._data = read_toml(study.scene)
        self._warm: set[str] = set()
        first = self._first_scene(study)
        with told_in_file(study.path):
            check_figure(self._figure, first)
        self.target = _target(study, study.tables.error, first)

    def read(self, settings: Settings) -> Settings:
        """All settings: a scene refuses what it does not read."""
        return settings

    def identity(self, settings: Settings) -> str:
        """The scene's tables with these settings, the figure, and the clock."""
        decisive = [self._tables(settings), self._figure.model_dump(), self._clock]
        return json.dumps(decisive, sort_keys=True, default=str)

    def run(self, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        """One run from start to end; the time of its set-up but not of the checks of the scene is in the seconds."""
        scene = self._scene(settings)
        self._warm_up(scene)
        history = simulate(scene, progress=lambda now: progress(now.time / now.end))
        summary = history.summary
        figure = read_figure(self._figure, history)
        slope = read_slope(self._figure, history, next(iter(self._parameters), None))
        return Outcome(figure, summary[f"{self._clock}_time"], summary["unknowns"], summary["steps"], slope)

    def _tables(self, settings: Settings) -> dict[str, Any]:
        tables = deepcopy(self._data)
        for key, value in (self._fixed | settings).items():
            assign(tables, key, value)
        return tables

    def _scene(self, settings: Settings) -> Scene:
        return scene_from_dict(self._tables(settings))

    def _first_scene(self, study: Study) -> Scene:
        """The first one that is valid; raises the first error if none is: then the study is wrong, not a setting."""
        errors: list[RigidfluidError] = []
        for settings in study.settings():
            try:
                return self._scene(settings)
            except RigidfluidError as error:
                errors.append(error)
        assert study.scene is not None
        with told_in_file(study.scene), told_where_set(study.path, study.tables.set_keys()):
            raise errors[0]

    def _warm_up(self, scene: Scene) -> None:
        """One step that is not measured, so that no backend's first run pays for imports and compiled kernels."""
        if scene.fluid.backend not in self._warm:
            simulate(scene.model_copy(update={"time": scene.time.model_copy(update={"end": scene.time.step})}))
            self._warm.add(scene.fluid.backend)


def _target(study: Study, error: ErrorTable, scene: Scene) -> Target:
    names, label = scene.scene.units, study.tables.study.label
    units = Units(None if names is None else names.model_dump(), scene.dimension)
    named = {knob: key_unit(scene, knob, units) for knob in study.knobs}
    named[""] = "" if label else figure_unit(error.figure, units)  # a label has its unit, if its author wanted one
    against = f"{error.reference:g}" if isinstance(error.reference, float) else "the finest run"
    return Target(str(error.figure), error.reference, label or str(error.figure), against, error.relative, named)
