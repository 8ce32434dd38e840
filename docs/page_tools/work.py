"""What a page is made from: runs and studies that are kept, so that it can be made again in a moment."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import rigidfluid
from page_tools.inputs import Inputs, changed, hashes, merged, sources
from page_tools.kept_run import Run, keep_run
from page_tools.places import RUNS, SCENES, STUDIES
from page_tools.record import Recorder, read_record
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.named_files import named_files
from rigidfluid.post.progress import RunsProgress
from rigidfluid.post.studies import load_study, run_study
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.run import TABLE


class Work:
    """The runs and studies of one page.

    Parameters
    ----------
    name : str
        Of the page.
    fresh : bool
        Whether to run all anew.

    Its ``folder``, out/validation/NAME, is where they are kept.
    """

    def __init__(self, name: str, fresh: bool = False, runs: Path = RUNS) -> None:
        self.folder, self._fresh = runs / name, fresh
        self._files: set[Path] = set()
        self._kept: dict[str, Inputs] = {}
        sources()  # as they are now, if they are edited while it goes on

    def run(self, label: str, scene: str | Scene, overrides: Iterable[str] = (), *, may_stop: bool = False) -> Run:
        """A scene, run in out/validation/NAME/LABEL, or taken from there.

        Parameters
        ----------
        label : str
            Name of the folder.
        scene : str or Scene
            A file of scenes/, or a scene that was made from one by `scene`.
        overrides : iterable of str
            As those of ``--set``, for a file.
        may_stop : bool
            Whether a step that fails leaves the run as far as it came, in place of a StepError.
        """
        scene = self.scene(scene, overrides) if isinstance(scene, str) else scene
        run = keep_run(scene, self.folder / label, fresh=self._fresh, may_stop=may_stop)
        self._kept[label] = read_record(run.folder)
        return run

    def scene(self, name: str, overrides: Iterable[str] = ()) -> Scene:
        """A scene of scenes/."""
        scene = rigidfluid.load_scene(self.file(SCENES / name), overrides)
        for path in named_files(scene.to_dict()):
            self.file(Path(path))
        return scene

    def study(self, name: str) -> Results:
        """The study studies/NAME.toml, with the runs that are kept of it."""
        study, folder = load_study(self.file(STUDIES / f"{name}.toml")), self.folder / f"study_{name}"
        if study.scene is not None:
            self.file(study.scene.resolve())
        print(f"{self.folder.name}: study {name}", flush=True)
        recorder = Recorder(folder, resumed=(folder / TABLE).exists() and not self._fresh)

        def observe(now: RunsProgress) -> None:
            if now.done.is_integer():
                recorder.note()

        results, _ = run_study(study, folder, fresh=self._fresh, progress=observe)
        if recorder.began:
            recorder.note()
        self._kept[f"study {name}"] = read_record(folder)
        return results

    def file(self, path: Path) -> Path:
        """A file that the page is made from."""
        self._files.add(path)
        return path

    @property
    def inputs(self) -> Inputs:
        """All that the page is made from: files, what is loaded now, and what was when its runs were made."""
        found = sources() | hashes(self._files)
        for kept in self._kept.values():
            found = merged(found, kept)
        return found

    @property
    def outdated(self) -> dict[str, list[str]]:
        """By run, the sources that have changed since it was made."""
        return {label: files for label, kept in self._kept.items() if (files := changed(kept))}
