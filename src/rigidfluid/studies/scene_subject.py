"""A scene as what a study runs."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from copy import deepcopy
from typing import Any

from rigidfluid.core.overrides import assign
from rigidfluid.core.run import run
from rigidfluid.core.scene import Scene, read_toml
from rigidfluid.errors import RigidfluidError
from rigidfluid.studies.figure import check_figure, read_figure
from rigidfluid.studies.model import Settings, Study
from rigidfluid.studies.subject import Outcome


class SceneSubject:
    """Runs of the study's scene, kept in memory.

    Parameters
    ----------
    study : Study
        The study; its scene file is read once.

    Raises
    ------
    SceneError
        If the scene cannot be read, or has no such figure.
    SceneError, PluginError
        If no setting gives a valid scene: then the study is wrong, not a setting.
    """

    def __init__(self, study: Study) -> None:
        self._fixed = study.tables.set
        self._figure = study.tables.error.figure
        self._data = read_toml(study.scene)
        self._is_warm = False
        check_figure(self._figure, self._first_valid(study.settings()))

    def identity(self, settings: Settings) -> str:
        """The scene's tables with these settings, and the figure."""
        decisive = [self._tables(settings), self._figure.model_dump()]
        return json.dumps(decisive, sort_keys=True, default=str)

    def run(self, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        """One run from start to end; the time of its set-up but not of the checks of the scene is in the seconds."""
        scene = Scene.from_dict(self._tables(settings))
        self._warm_up(scene)
        history = run(scene, progress=lambda now: progress(now.time / now.end))
        summary = history.summary
        figure = read_figure(self._figure, history)
        return Outcome(figure, summary["wall_time"], summary["unknowns"], summary["steps"])

    def _tables(self, settings: Settings) -> dict[str, Any]:
        tables = deepcopy(self._data)
        for key, value in (self._fixed | settings).items():
            assign(tables, key, value)
        return tables

    def _first_valid(self, all_settings: Iterable[Settings]) -> Scene:
        first: RigidfluidError | None = None
        for settings in all_settings:
            try:
                return Scene.from_dict(self._tables(settings))
            except RigidfluidError as error:
                first = first or error
        assert first is not None
        raise first

    def _warm_up(self, scene: Scene) -> None:
        """One step that is not measured, so that the first run does not pay for imports and compiled kernels."""
        if not self._is_warm:
            run(scene.model_copy(update={"time": scene.time.model_copy(update={"end": scene.time.step})}))
            self._is_warm = True
