"""A run that goes on from damage to other results does not hold, and no harm is done but the one that is told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from attacks.checkpoint_damages import HARMS, Folders
from attacks.checkpoints import EQUAL, held
from attacks.contained import FINISHED, REFUSED, Ending, ending_of
from attacks.small_runs import DRY, WET, SmallRun, differences

import rigidfluid
from rigidfluid.core.output.sealed_file import is_intact


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


def test_an_edit_that_renews_the_digest_is_seen(folders: Folders, tmp_path: Path) -> None:
    """The digest is right, and what it is of is not; only times that a part of the steps took may be missing."""
    broken, unbroken = tmp_path / "broken", tmp_path / "unbroken"
    rigidfluid.run(DRY.scene(0.25), broken)
    rigidfluid.run(DRY.scene(), unbroken)

    def taken_up() -> str:
        rigidfluid.run(DRY.scene(), broken, resume=True)
        return "".join(differences(broken, unbroken)) or EQUAL

    whole, endings = contents(broken), []
    for seed in range(20):
        HARMS["state.h5: edited, its digest renewed"](replace(folders, to_break=broken), np.random.default_rng(seed))
        assert is_intact((broken / "state.h5").read_bytes())
        endings.append(ending_of(taken_up))
        restore(broken, whole)
    assert all(held(ending, broken) for ending in endings)
    assert sum(ending.how == REFUSED for ending in endings) >= 15


@pytest.mark.parametrize("small", [DRY, WET])
def test_runs_of_some_quarters_of_the_time_end_at_an_output(small: SmallRun) -> None:
    """One that ended between two outputs would have an output that the whole run has not."""
    every = small.scene().output.every
    for share in (0.25, 0.5, 0.75):
        assert share * small.end / every == pytest.approx(round(share * small.end / every))


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink()}


def restore(folder: Path, whole: dict[Path, bytes]) -> None:
    for path in sorted(folder.rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() and path.name != "fields" else path.is_dir() or path.unlink()
    for path, data in whole.items():
        path.write_bytes(data)
