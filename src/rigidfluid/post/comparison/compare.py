"""Runs a scene with several backends, compares the results, and writes what was found."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Sequence
from pathlib import Path

from rigidfluid.core.output.disk import replace_text, writing
from rigidfluid.core.output.results_folder import Product, take_folder
from rigidfluid.core.scene.scene import Scene
from rigidfluid.post.comparison.comparison import Comparison
from rigidfluid.post.comparison.differences import Pair, pair
from rigidfluid.post.comparison.page import write_page
from rigidfluid.post.comparison.runs import Run, backend_run
from rigidfluid.post.comparison.scenes import backend_scenes
from rigidfluid.post.progress import Observer, begin_run

TABLE = "comparison.json"


def compare(
    path: str | Path,
    backends: Sequence[str],
    overrides: Sequence[str] = (),
    out: Path | None = None,
    *,
    fresh: bool = False,
    progress: Observer | None = None,
) -> tuple[Comparison, list[Path]]:
    """Run a scene once with each of the ``backends``, in processes of their own, and compare the results.

    The first backend is the reference. Runs go to ``<out>/<backend>``, ``out/<scene name>_compare`` without ``out``;
    ``fresh`` repeats runs that are there already. Returns the comparison, in which a failed run has its error and is in
    no pair, and the files written. Raises SceneError or PluginError before anything runs, OutputError if the disk
    refuses.
    """
    scenes = backend_scenes(path, backends, overrides)
    name = scenes[backends[0]].name
    out = Path("out") / f"{name}_compare" if out is None else Path(out)
    with take_folder(out, product_of(backends), new=True):
        runs = _runs(scenes, out, fresh, progress)
        comparison = Comparison(_command(path, backends, overrides), runs, _pairs(runs))
        with writing(out / TABLE):
            text = json.dumps(comparison.to_dict(), indent=2, allow_nan=False, ensure_ascii=False)
            replace_text(out / TABLE, text + "\n")
        return comparison, [out / TABLE, *write_page(comparison, name, out)]


def product_of(backends: Sequence[str]) -> Product:
    """Files of a comparison, next to the runs in folders of their own."""
    names = "|".join(map(re.escape, backends))
    own = r"comparison\.(json(\.part)?|html)|(differences|body_\d+)\.(png|svg)"
    return Product("comparison", rf"({names})\.(toml|log)|{own}")


def _runs(scenes: dict[str, Scene], out: Path, fresh: bool, progress: Observer | None) -> tuple[Run, ...]:
    runs = []
    for number, (backend, scene) in enumerate(scenes.items()):
        show = begin_run(progress, number, len(scenes), backend)
        runs.append(backend_run(backend, scene, out, fresh=fresh, progress=show))
    return tuple(runs)


def _command(path: str | Path, backends: Sequence[str], overrides: Sequence[str]) -> str:
    options = [word for name in backends for word in ("--backend", name)]
    options += [word for assignment in overrides for word in ("--set", assignment)]
    return shlex.join(["rigidfluid", "compare", str(path), *options])


def _pairs(runs: Sequence[Run]) -> tuple[Pair, ...]:
    complete = [(run.backend, run.results) for run in runs if run.results is not None]
    return tuple(pair(complete[0], other) for other in complete[1:])
