"""Studies of kernels: their errors and orders, what is run again, and how wrong knobs are refused."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from falling import SCENES
from typer.testing import CliRunner

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.cli import app
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.detectors.brute_force import BruteForceDetector, BruteForceOptions
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.errors import RigidfluidError
from rigidfluid.post.studies import load_study, run_study
from rigidfluid.post.studies.kernels import KERNELS
from rigidfluid.post.studies.kernels.convex_gaps import true_gap
from rigidfluid.post.studies.kernels.detector_gaps import DetectorGaps
from rigidfluid.post.studies.kernels.ring_distance import RingDistance
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.subject import Outcome

FIELD = """
[study]
name = "field"
kernel = "distance-field"
group = "accuracy"

[vary]
accuracy = ["exact", "first-order"]
size = [0.2, 0.1]
threads = [1, 2]
"""
DETECTOR = """
[study]
name = "gaps"
kernel = "detector"
group = "options.narrow_band.accuracy"

[set]
bodies = 4
reach = 0.4
poses = 1

[vary]
detector = ["sphere", "narrow_band"]
size = [0.1, 0.05]
options.narrow_band.accuracy = ["exact", "first-order"]
"""


def silent(_: float) -> None:
    pass


def error_of(kernel: Any, **knobs: Any) -> float:
    return float(kernel(**knobs).run(silent).figure)


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "study.toml"
    path.write_text(text)
    return path


def run_text(text: str, tmp_path: Path) -> Results:
    return run_study(load_study(written(tmp_path, text)), tmp_path / "out")[0]


@pytest.mark.parametrize("norm", ["largest", "mean"])
@pytest.mark.parametrize(("accuracy", "order"), [("exact", 2.0), ("first-order", 1.0)])
@pytest.mark.parametrize(("dimension", "sizes"), [(2, (0.05, 0.0125)), (3, (0.2, 0.1))])
def test_order_of_the_distance(
    dimension: int, sizes: tuple[float, float], accuracy: str, order: float, norm: str
) -> None:
    errors = [error_of(RingDistance, size=size, dimension=dimension, accuracy=accuracy, norm=norm) for size in sizes]
    assert np.log(errors[0] / errors[1]) / np.log(sizes[0] / sizes[1]) == pytest.approx(order, abs=0.25)


def test_distance_is_off_by_the_polygon_alone() -> None:
    """The sagitta h²/(8R) of the inner polygon."""
    assert error_of(RingDistance, size=0.05) == pytest.approx(0.05**2 / (8 * 0.3), rel=0.05)


def test_band_and_threads_keep_the_error() -> None:
    everywhere = error_of(RingDistance, size=0.05, norm="mean")
    assert error_of(RingDistance, size=0.05, norm="mean", threads=3) == pytest.approx(everywhere, rel=1e-12)
    assert error_of(RingDistance, size=0.05, band_width=0.2) <= error_of(RingDistance, size=0.05)
    band = {"size": 0.05, "norm": "mean", "band_width": 0.2}
    assert error_of(RingDistance, **band) != everywhere
    assert error_of(RingDistance, **band, threads=3) == pytest.approx(error_of(RingDistance, **band), rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_oracle_is_that_of_brute_force(dimension: int) -> None:
    rng = np.random.default_rng(2)
    for _ in range(5):
        semi_axes = rng.uniform(0.1, 0.5, (2, dimension))
        turns = rng.normal(size=(2, 1 if dimension == 2 else 4))
        orientation = turns if dimension == 2 else turns / np.linalg.norm(turns, axis=1, keepdims=True)
        pose = Pose(np.eye(2, dimension) * rng.uniform(0.8, 1.2), orientation)
        bodies = [Ellipsoid(EllipsoidOptions(semi_axes=row), dimension) for row in semi_axes.tolist()]
        searched = BruteForceDetector(BruteForceOptions(samples=400), bodies, []).detect(pose, None, np.inf)
        assert searched.gap[0] > 0
        assert true_gap(semi_axes, pose, 0, 1) == pytest.approx(searched.gap[0], rel=0, abs=1e-12)


@pytest.mark.parametrize(
    ("detector", "knobs", "lowest", "highest"),
    [
        ("sphere", {}, 0.0, 1e-15),
        ("sphere", {"dimension": 3, "bodies": 8}, 0.0, 1e-15),
        ("brute_force", {"aspect": 5.0}, 0.0, 1e-12),
        ("brute_force", {"aspect": 2.0, "dimension": 3, "bodies": 4}, 0.0, 1e-12),
        # each of two disks is off by h²/(8R) at most, R ≥ 0.3
        ("narrow_band", {"size": 0.1}, 1e-4, 2 * 0.1**2 / (8 * 0.3)),
        ("fast_marching", {"size": 0.1}, 1e-4, 2 * 0.1**2 / (8 * 0.3)),
    ],
)
def test_errors_of_detectors(detector: str, knobs: dict[str, Any], lowest: float, highest: float) -> None:
    error = error_of(DetectorGaps, **{"detector": detector, "reach": 0.4, "poses": 2} | knobs)
    assert lowest < error <= highest


@pytest.mark.parametrize("fault", ["gap", "missing", "false"])
def test_wrong_gaps_and_pairs_are_errors(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    original = SphereDetector.detect

    def detect(self: SphereDetector, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        found = original(self, pose, mesh, reach if fault != "false" else 10.0)
        columns = {name: getattr(found, name) for name in Contacts.__slots__ if name not in ("shift", "curvatures")}
        if fault == "false":
            columns["gap"] = np.minimum(columns["gap"], 0.5 * reach)
        if fault == "gap":
            columns["gap"] = columns["gap"] * 1.01
        if fault == "missing":
            columns = {name: values[1:] for name, values in columns.items()}
        return Contacts(**columns)

    monkeypatch.setattr(SphereDetector, "detect", detect)
    assert error_of(DetectorGaps, detector="sphere", reach=0.4) > 1e-4


def test_poses_come_from_the_seed() -> None:
    errors = [error_of(DetectorGaps, detector="narrow_band", reach=0.4, seed=seed) for seed in (0, 0, 1)]
    assert errors[0] == errors[1] != errors[2]


def test_knobs_that_a_run_does_not_read_are_not_varied(tmp_path: Path) -> None:
    results = run_text(DETECTOR, tmp_path)
    assert len(results.plan) == 5
    assert results.plan[0] == {"detector": "sphere"}
    with (tmp_path / "out" / "study.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["size"] for row in rows] == ["", "0.1", "0.1", "0.05", "0.05"]
    assert {row["status"] for row in rows} == {"complete"}
    plot = (tmp_path / "out" / "study.svg").read_text(encoding="utf-8")
    for text in ("without accuracy", "accuracy first-order", "error of gap", "against the gap of the shapes"):
        assert f"<!-- {text} -->" in plot
    page = (tmp_path / "out" / "study.html").read_text(encoding="utf-8")
    assert "Figure: error of gap. Reference: 0." in page
    assert "Scene file" not in page


def test_a_stopped_study_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[RingDistance] = []
    original = RingDistance.run

    def run(self: RingDistance, progress: Callable[[float], None]) -> Outcome:
        if len(ran) == 3:
            ran.append(self)
            raise KeyboardInterrupt
        ran.append(self)
        return original(self, progress)

    monkeypatch.setattr(RingDistance, "run", run)
    path = written(tmp_path, FIELD)
    command = ["study", str(path), "--out", str(tmp_path / "out")]
    assert CliRunner().invoke(app, command).exit_code == 130
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 0, result.stderr
    assert "6 runs, 0 failed; reference 0" in result.stdout
    assert len(ran) == 6 + 1  # the first-order march has one thread; one run was stopped
    run_text(FIELD.replace("[0.2, 0.1]", "[0.2, 0.1, 0.3]"), tmp_path)
    assert [kernel.size for kernel in ran[7:]] == [0.3] * 3


def test_a_detector_that_refuses_the_shapes_fails_alone(tmp_path: Path) -> None:
    results = run_text(DETECTOR.replace("reach = 0.4", "reach = 1.0\naspect = 2.0"), tmp_path)
    assert [row.status for row in results.rows.values()] == ["failed"] + 4 * ["complete"]
    assert "balls only" in results.rows[results.prints[0]].message


@pytest.mark.parametrize(
    ("study", "old", "new", "texts"),
    [
        (FIELD, "distance-field", "distance-feild", ("study.kernel", "Did you mean 'distance-field'?")),
        (FIELD, "size =", "sice =", ("sice", "a key that nothing reads", "Did you mean 'size'?")),
        (FIELD, "[0.2, 0.1]", "[-0.2]", ("size", "-0.2", "greater than 0")),
        (FIELD, '["exact", "first-order"]', '["exakt"]', ("accuracy", "exakt", "'exact' or 'first-order'")),
        (FIELD, '["exact", "first-order"]', '["first-order"]', ("threads", "a knob that no run reads", "Remove it")),
        (FIELD, 'kernel = "distance-field"', "", ("study", "neither scene nor kernel", "one of scene and kernel")),
        (FIELD, "kernel =", 'scene = "a.toml"\nkernel =', ("study", "scene and kernel", "one of scene and kernel")),
        (FIELD, "[vary]", '[error]\nfigure = "time"\nreference = 0\n[vary]', ("error", "a kernel has its own")),
        (FIELD, "kernel =", 'seconds = "cpu"\nkernel =', ("study.seconds", "'wall' with study.kernel")),
        (DETECTOR, '["sphere", "narrow_band"]', '["narow_band"]', ("detector", "Did you mean 'narrow_band'?")),
        (DETECTOR, "narrow_band.accuracy", "narrow_band.acuracy", ("acuracy", "Did you mean 'accuracy'?")),
        (DETECTOR, '"narrow_band"]', "]", ("size", "a knob that no run reads")),
        (DETECTOR, "bodies = 4", "bodies = 1", ("bodies", "1", "greater than or equal to 2")),
        (DETECTOR, "bodies = 4", "bodes = 4", ("bodes", "Did you mean 'bodies'?")),
    ],
)
def test_wrong_studies(study: str, old: str, new: str, texts: tuple[str, ...], tmp_path: Path) -> None:
    assert old in study
    with pytest.raises(RigidfluidError) as caught:
        run_text(study.replace(old, new), tmp_path)
    for text in texts:
        assert text in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_nothing_within_reach_is_no_error_of_zero() -> None:
    with pytest.raises(RigidfluidError, match=r"reach: found 1e-09"):
        DetectorGaps(detector="sphere", reach=1e-9).run(silent)


def test_every_knob_is_explained() -> None:
    page = (SCENES.parent / "docs" / "studies.md").read_text(encoding="utf-8")
    for name, kernel in KERNELS.items():
        section = page.partition(f"### `{name}`")[2].partition("\n#")[0]
        assert [knob for knob in kernel.model_fields if f"`{knob}`" not in section] == []
