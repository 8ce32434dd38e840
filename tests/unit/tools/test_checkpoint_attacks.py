"""A run that goes on from damage to other results does not hold, and no harm is done but the one that is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from attacks.checkpoint_damages import HARMS, Folders
from attacks.checkpoints import EQUAL, held
from attacks.contained import FINISHED, REFUSED, Ending
from attacks.small_runs import DRY

import rigidfluid


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Folders:
    places = [tmp_path_factory.mktemp(name) for name in ("broken", "earlier", "later", "other")]
    for place, share in zip(places, (0.2, 0.1, 0.3, 0.2), strict=True):
        rigidfluid.run(DRY.scene(share), place)
    return Folders(*places)


def test_only_the_same_results_hold(tmp_path: Path) -> None:
    assert held(Ending(FINISHED, EQUAL), tmp_path)
    assert not held(Ending(FINISHED, "other results in bodies.csv"), tmp_path)
    assert held(Ending(REFUSED, "…", str(tmp_path / "state.h5")), tmp_path)
    assert not held(Ending(REFUSED, "…", "time.end"), tmp_path)
    assert not held(Ending("KeyError", "…"), tmp_path)


@pytest.mark.parametrize("group", HARMS)
def test_a_harm_changes_the_folder_that_is_to_be_broken_alone(folders: Folders, group: str) -> None:
    kept = {place: contents(place) for place in (folders.earlier, folders.later, folders.other)}
    whole, broken = contents(folders.to_break), False
    for seed in range(3):
        HARMS[group](folders, np.random.default_rng(seed))
        broken |= contents(folders.to_break) != whole
        restore(folders.to_break, whole)
    assert broken
    assert {place: contents(place) for place in kept} == kept


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink()}


def restore(folder: Path, whole: dict[Path, bytes]) -> None:
    for path in sorted(folder.rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() and path.name != "fields" else path.is_dir() or path.unlink()
    for path, data in whole.items():
        path.write_bytes(data)
