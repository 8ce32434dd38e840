"""Pictures between periodic surfaces show bodies where their images are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scenes import dry_tables

import rigidfluid
from rigidfluid.post.reports.bodies import placed_bodies, seen_bodies
from rigidfluid.post.reports.results import Results, read_results

BODY = {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.5, 0.5], "velocity": [2.3, 0.0]}


def run(folder: Path, periodic: bool) -> Results:
    sides = [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}] if periodic else []
    body = BODY if periodic else BODY | {"velocity": [0.1, 0.0]}
    rigidfluid.run(rigidfluid.scene_from_dict(dry_tables(body, boundary=sides)), folder)
    return read_results(folder)


def test_a_body_that_has_gone_round_is_seen_in_the_domain(tmp_path: Path) -> None:
    results = run(tmp_path, periodic=True)
    assert results.quantity("position")[-1, 0, 0] > 2.5
    seen = sorted(body.centre[0] for body in seen_bodies(results, -1))
    np.testing.assert_allclose(seen, [-0.2, 0.8, 1.8], atol=1e-9)
    assert placed_bodies(results, -1)[0].centre[0] > 2.5
    path = results.path(0)
    assert path[:, 0].min() >= 0.0
    assert path[:, 0].max() < 1.0


def test_between_walls_a_body_is_seen_once(tmp_path: Path) -> None:
    results = run(tmp_path, periodic=False)
    assert [body.centre.tolist() for body in seen_bodies(results, -1)] == [results.path(0)[-1].tolist()]
