"""What a page is made from: runs and studies that are kept, so that it can be made again in a moment."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import rigidfluid
from page_tools.cpu_time import cpu_seconds
from page_tools.first_steps import STEPS, first_steps, steps_of
from page_tools.kept_rows import KeptRows, Row
from page_tools.kept_run import Run, keep_run
from page_tools.kept_tests import Found, kept_tests
from page_tools.made import Made
from page_tools.places import MEASURED, ROOT, RUNS, SCENES, STUDIES
from page_tools.provenance import commit, source_digest
from page_tools.record import RunRecord
from page_tools.settings import Settings, override, settings_of
from rigidfluid.core.scene.scene import Scene
from rigidfluid.post.progress import RunsProgress
from rigidfluid.post.studies import load_study, run_study
from rigidfluid.post.studies.results import Results


class Work:
    """The runs and studies of one page.

    Parameters
    ----------
    name : str
        Of the page.
    fresh : bool
        Whether to run all anew.
    present : bool
        Whether to run anew what other sources than the present ones have made.

    measured : Path
        Where rows are kept that the page measures itself.

    Its ``folder``, out/validation/NAME, is where runs and studies are kept; ``runs`` is what is recorded of each run.
    """

    def __init__(
        self, name: str, *, fresh: bool = False, present: bool = False, runs: Path = RUNS, measured: Path = MEASURED
    ) -> None:
        self.folder, self._fresh, self._present = runs / name, fresh, present
        self._rows = measured / f"{name}.json"
        self.runs: dict[str, RunRecord] = {}
        self._made: dict[str, Made] = {}
        self._earlier = -cpu_seconds()
        source_digest()  # as they are now, if they are edited while it goes on

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
        folder, start = self.folder / label, cpu_seconds()
        run = keep_run(scene, folder, fresh=self._anew(folder), may_stop=may_stop)
        made, settings = self._note(label, Made.read(folder), run.cpu_seconds, start), settings_of(scene)
        self.runs[label] = RunRecord(
            settings.command, settings, made.commits, round(run.cpu_seconds, 1), steps_of(run.history)
        )
        return run

    def watch(self, label: str, settings: Settings) -> None:
        """Record the first steps of a scene that is run elsewhere, as by a study, so that others are seen later."""
        start = cpu_seconds()
        steps = first_steps(settings.scene, STEPS)
        spent = round(cpu_seconds() - start, 1)
        self.runs[label] = RunRecord(settings.command, settings, (commit(),), spent, steps)

    def scene(self, name: str, overrides: Iterable[str] = ()) -> Scene:
        """A scene of scenes/."""
        return rigidfluid.load_scene(SCENES / name, overrides)

    def study(self, name: str) -> Results:
        """The study studies/NAME.toml, with the runs that are kept of it."""
        study, folder = load_study(STUDIES / f"{name}.toml"), self.folder / f"study_{name}"
        print(f"{self.folder.name}: study {name}", flush=True)
        start, kept = cpu_seconds(), folder.exists() and not self._anew(folder)
        before = Made.read(folder) if kept else Made()

        def observe(now: RunsProgress) -> None:
            if now.done.is_integer():
                before.now(cpu_seconds() - start).write(folder)

        results, _ = run_study(study, folder, fresh=not kept, progress=observe)
        made = Made.read(folder)
        self._note(f"study {name}", made, made.cpu_seconds, start)
        if study.scene is not None:
            overrides = [override(key, value) for key, value in (study.tables.set | results.plan[0]).items()]
            self.watch(f"study {name}", Settings(str(study.scene.resolve().relative_to(ROOT)), overrides))
        return results

    def rows(self, measure: Callable[[], Iterable[Row]]) -> list[Row]:
        """What the page measures; where docs/validation/measured/NAME.json has it, it is taken from there."""
        start, kept = cpu_seconds(), self._kept_rows()
        if kept is None:
            print(f"{self.folder.name}: measures", flush=True)
            found = list(measure())
            KeptRows(Made().now(round(cpu_seconds() - start, 1)), found).write(self._rows)
            kept = KeptRows.read(self._rows)
        self._note("rows", kept.made, kept.made.cpu_seconds, start)
        return kept.rows

    def cases(self, measures: Mapping[str, Callable[[], Iterable[Row]]]) -> list[Row]:
        """What the page measures in several cases, each with its name; where it was stopped, it goes on with the next
        one."""
        start, kept = cpu_seconds(), self._kept_rows() or KeptRows(Made(), [])
        for case, measure in measures.items():
            if all(row["case"] != case for row in kept.rows):
                print(f"{self.folder.name}: measures {case}", flush=True)
                begun, found = cpu_seconds(), [{"case": case, **row} for row in measure()]
                kept = KeptRows(kept.made.now(round(cpu_seconds() - begun, 1)), [*kept.rows, *found])
                kept.write(self._rows)
        self._note("rows", kept.made, kept.made.cpu_seconds, start)
        return [row for row in kept.rows if row["case"] in measures]

    def _kept_rows(self) -> KeptRows | None:
        """Rows that need not be measured."""
        kept = KeptRows.read(self._rows) if self._rows.exists() and not self._fresh else None
        return None if kept is None or (self._present and not kept.made.is_present) else kept

    def tests(self, path: Path) -> Found:
        """What the validation tests of a file have found."""
        print(f"{self.folder.name}: {path.name}", flush=True)
        start = cpu_seconds()
        found = kept_tests(path, self.folder, fresh=self._fresh)
        self._earlier += max(found.cpu_seconds - (cpu_seconds() - start), 0.0)
        return found

    def _anew(self, folder: Path) -> bool:
        return self._fresh or (self._present and folder.exists() and not Made.read(folder).is_present)

    def _note(self, label: str, made: Made, seconds: float, start: float) -> Made:
        """Note what has ``made`` results that took some ``seconds``, and what of them was before this process [s]."""
        self._made[label] = made
        self._earlier += max(seconds - (cpu_seconds() - start), 0.0)
        return made

    @property
    def cpu_seconds(self) -> float:
        """CPU time of all that is kept, and of making the page until now [s]."""
        return cpu_seconds() + self._earlier

    @property
    def sources(self) -> tuple[str, ...]:
        """Digests of all sources that have made its runs, and of the present ones, that have made the rest."""
        kept = [source for made in self._made.values() for source in made.sources]
        return tuple(dict.fromkeys([*kept, source_digest()]))

    @property
    def outdated(self) -> dict[str, str]:
        """The commits that have made a run, by its name, where other sources than the present ones were at it."""
        return {label: ", ".join(made.commits) for label, made in self._made.items() if not made.is_present}
