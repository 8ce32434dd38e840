"""Bodies enter and leave by the tables of a scene."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenes import dry_tables, wet_tables

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.core.seeding.regions import region_of
from rigidfluid.errors import SceneError, SceneErrors, StepError

POST = {"name": "post", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.8, 0.8], "fixed": True}
SHAPE = [{"type": "sphere", "radius": 0.05}]
REGION = {"type": "box", "lower": [0.1, 0.6], "upper": [0.5, 0.9]}
OUTSIDE = {"type": "box", "lower": [1.1, 0.6], "upper": [1.5, 0.9]}
LARGE = [{"type": "sphere", "radius": 0.4}]
SOURCE = {"name": "grain", "shape": SHAPE, "density": 2.0, "region": REGION, "velocity": [0.0, -1.0]}
SINK = {"on": "bottom", "gap": 0.1}


def tables(**changes: Any) -> dict[str, Any]:
    given = {"source": [SOURCE | {"every": 0.2}], "sink": [SINK], "fluid": {"gravity": [0.0, 0.0]}, "end": 1.0}
    return dry_tables(POST, **(given | changes))


def names_over_time(run: Simulation) -> dict[str, tuple[float, float]]:
    """First and last time of each body in the table."""
    bodies = run.history.bodies
    return {
        str(name): (bodies["time"][bodies["body"] == name].min(), bodies["time"][bodies["body"] == name].max())
        for name in np.unique(bodies["body"])
    }


def test_bodies_enter_at_intervals_and_leave_at_a_surface() -> None:
    run = Simulation(scene_from_dict(tables()))
    run.go()
    there = names_over_time(run)
    assert {name: pytest.approx(first, abs=1e-9) for name, (first, _) in there.items() if name != "post"} == {
        f"grain{number}": 0.2 * number + 0.01 for number in range(5)
    }
    bodies = run.history.bodies
    left = [name for name, (_, last) in there.items() if last < 1.0 - 1e-9]
    assert len(left) >= 2
    for name in left:
        lowest = bodies["y"][bodies["body"] == name].min()
        assert 0.15 - 0.0101 <= lowest <= 0.15
    entered, gone = 5, len(left)
    energy = 0.5 * 2.0 * np.pi * 0.05**2
    assert run.state.ledger.exchange == pytest.approx((entered - gone) * energy, rel=1e-12)
    assert abs(run.state.ledger.residual) < 1e-13


def test_bodies_enter_at_given_times() -> None:
    run = Simulation(scene_from_dict(tables(source=[SOURCE | {"times": [0.1, 0.1, 0.35]}], sink=[], end=0.4)))
    run.go()
    first = {name: when for name, (when, _) in names_over_time(run).items() if name != "post"}
    assert first == {"grain0": pytest.approx(0.11), "grain1": pytest.approx(0.11), "grain2": pytest.approx(0.36)}


def test_a_source_ends_with_its_number() -> None:
    run = Simulation(scene_from_dict(tables(source=[SOURCE | {"every": 0.1, "number": 3, "start": 0.3}], sink=[])))
    run.go()
    assert list(run.bodies) == ["post", "grain0", "grain1", "grain2"]


def test_a_body_waits_for_room() -> None:
    """The region holds one ball, and each must be gone before the next one enters."""
    narrow = {"type": "box", "lower": [0.2, 0.7], "upper": [0.32, 0.82]}
    run = Simulation(scene_from_dict(tables(source=[SOURCE | {"every": 0.02, "region": narrow}], sink=[])))
    run.go(0.25)
    first = sorted(when for name, (when, _) in names_over_time(run).items() if name != "post")
    assert len(first) >= 2
    assert all(gap >= 0.1 - 0.02 for gap in np.diff(first))
    run.finish("complete")
    waiting = 13 - len(first)
    told = run.history.summary["remarks"][-1]["text"]
    assert told.endswith(f"'grain' had no room in its region for {waiting} that were due")


def test_bodies_leave_in_a_region() -> None:
    region = {"type": "box", "lower": [0.0, 0.0], "upper": [1.0, 0.4]}
    run = Simulation(scene_from_dict(tables(sink=[{"region": region}])))
    run.go()
    there = names_over_time(run)
    bodies = run.history.bodies
    assert min(bodies["y"]) >= 0.4 - 0.0101
    assert there["grain0"][1] < 0.6


def test_the_same_seed_gives_the_same_bodies_after_resuming(tmp_path: Path) -> None:
    changes: dict[str, Any] = {"source": [SOURCE | {"every": 0.06, "velocity_deviation": 0.1}], "sink": [SINK]}
    changes |= {"end": 0.2, "output": {"every": 0.1}, "fluid": {"gravity": [0.0, -1.0]}, "step": 0.02}
    case = scene_from_dict(wet_tables(POST, **changes))
    whole = Simulation(case)
    whole.go()
    run = Simulation(case, tmp_path)
    run.go(0.1)
    run.close()
    resumed = Simulation(case, tmp_path, resume=True)
    resumed.go()
    assert list(resumed.bodies) == list(whole.bodies)
    assert len(resumed.bodies) > 2
    np.testing.assert_array_equal(resumed.state.pose.position, whole.state.pose.position)
    resumed.finish("complete")
    resumed.close()


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"source": [SOURCE]}, "source.0.every"),
        ({"source": [SOURCE | {"every": 0.1, "times": [0.1]}]}, "source.0.every"),
        ({"source": [SOURCE | {"times": [0.2, 0.1]}]}, "source.0.times"),
        ({"source": [SOURCE | {"times": [0.2], "number": 3}]}, "source.0.number"),
        ({"source": [SOURCE | {"every": 0.1, "name": "post", "shape": [{"type": "sphere"}]}]}, "source.0.shape.0"),
        ({"source": [SOURCE | {"every": 0.1, "region": OUTSIDE}]}, "source.0.region"),
        ({"source": [SOURCE | {"times": []}]}, "source.0.times: found []; allowed is at least 1 entry."),
        ({"source": [SOURCE | {"every": 0.1, "shape": LARGE}]}, "source.0.shape: found a body of 4.19 of the region"),
        ({"sink": [{}]}, "sink.0.on"),
        ({"sink": [{"region": OUTSIDE}]}, "sink.0.region: found a region from"),
        ({"sink": [{"on": "outlet"}]}, "sink.0.on"),
        ({"sink": [{"region": REGION, "gap": 0.1}]}, "sink.0.gap"),
        ({"output": {"every": 1.0, "error_bars": True}}, "output.error_bars"),
    ],
)
def test_wrong_tables_are_told_by_their_keys(changes: dict[str, Any], field: str) -> None:
    with pytest.raises((SceneError, SceneErrors), match=re.escape(field)):
        scene_from_dict(tables(**changes))


def test_a_name_that_a_body_has() -> None:
    with pytest.raises(SceneError, match="grain1"):
        scene_from_dict(
            dry_tables(POST, POST | {"name": "grain1", "position": [0.2, 0.2]}, source=[SOURCE | {"every": 1.0}])
        )


@pytest.mark.parametrize("other", ["grain", "grain1"])
def test_two_sources_give_no_name_twice(other: str) -> None:
    """Bodies of the second would count as those of the first, and not enter."""
    with pytest.raises(SceneError, match=r"source\.\d\.name"):
        scene_from_dict(tables(source=[SOURCE | {"every": 0.1, "name": name} for name in ("grain", other)]))


def test_nobody_takes_a_name_that_a_source_will_give() -> None:
    run = Simulation(scene_from_dict(tables(sink=[])))
    with pytest.raises(SceneError, match=r"body\.name"):
        run.add({"name": "grain7", "type": "sphere", "radius": 0.05, "density": 2.0, "position": [0.3, 0.3]})


def test_a_body_that_never_has_room_stops_the_run() -> None:
    """Only the larger ones, which are drawn later, are too large for the region."""
    shapes = [SHAPE[0] | {"weight": 5.0}, {"type": "sphere", "radius": 0.2}]
    run = Simulation(scene_from_dict(tables(source=[SOURCE | {"every": 0.01, "shape": shapes}], sink=[])))
    with pytest.raises(StepError, match=r"enter or leave at time .*source\.0"):
        run.go()
    assert run.state.count > 0


WEIGHTLESS = {"gravity": [0.0, 0.0]}
PERIODIC = [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}]


def test_a_body_waits_for_an_image_to_leave_its_region() -> None:
    """One ball reaches across the seam into the region at its other side."""
    seam = POST | {"position": [0.06, 0.75], "velocity": [-1.0, 0.0], "fixed": False}
    region = {"type": "box", "lower": [0.85, 0.68], "upper": [1.0, 0.82]}
    source = [SOURCE | {"times": [0.15], "region": region, "velocity": [0.0, 0.0]}]
    run = Simulation(scene_from_dict(dry_tables(seam, boundary=PERIODIC, source=source, end=0.6, fluid=WEIGHTLESS)))
    run.go()
    assert names_over_time(run)["grain0"][0] > 0.25


def test_an_image_comes_to_a_sink() -> None:
    past = POST | {"name": "past", "position": [0.7, 0.4], "velocity": [2.0, 0.0], "fixed": False}
    region = {"type": "box", "lower": [0.1, 0.2], "upper": [0.4, 0.6]}
    run = Simulation(
        scene_from_dict(dry_tables(POST, past, boundary=PERIODIC, sink=[{"region": region}], end=0.5, fluid=WEIGHTLESS))
    )
    run.go()
    assert list(run.bodies) == ["post"]


def test_a_detector_that_is_named_knows_all_shapes_of_a_source() -> None:
    shapes = [SHAPE[0] | {"weight": 1e6}, {"type": "ellipsoid", "semi_axes": [0.05, 0.04]}]
    given = tables(source=[SOURCE | {"every": 0.1, "shape": shapes}])
    scene_from_dict(given)
    with pytest.raises(SceneError, match=r"contact\.detector"):
        scene_from_dict(given | {"contact": {"detector": "sphere"}})


def test_shapes_of_a_source_that_no_mesher_puts_in_are_refused_at_once() -> None:
    """And not only when the first one enters."""
    square = {"type": "polygon", "points": [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]]}
    entering = SOURCE | {"every": 0.2, "shape": [SHAPE[0], square]}
    given = wet_tables(POST, source=[entering])
    scene_from_dict(given)
    with pytest.raises(SceneError, match=r"mesh\.inserter: found 'cad' with source\.0\.shape\.1 made of facets"):
        scene_from_dict(given | {"mesh": given["mesh"] | {"inserter": "cad"}})


def test_a_law_leaves_with_the_body_that_it_names() -> None:
    falling = POST | {"name": "falling", "position": [0.3, 0.4], "velocity": [0.0, -1.0], "fixed": False}
    law = {"law": "spring-dashpot", "range": 0.02, "stiffness": 1e4, "restitution": 0.5, "names": ["post", "falling"]}
    run = Simulation(scene_from_dict(dry_tables(POST, falling, interaction=[law], sink=[SINK], end=0.4)))
    run.go()
    assert list(run.bodies) == ["post"]


BOUNCE = {"law": "spring-dashpot", "range": 0.02, "stiffness": 1e4}
FALLING = {"region": {"type": "box", "lower": [0.7, 0.78], "upper": [0.9, 0.98]}, "times": [0.0]}


@pytest.mark.parametrize("names", [["grain*", "post"], ["grain*"]], ids=["pair", "all"])
def test_a_law_acts_on_the_bodies_of_a_source_that_it_names(names: list[str]) -> None:
    law = BOUNCE | {"names": names}
    given = tables(source=[SOURCE | FALLING], sink=[], interaction=[law], end=0.3, step=0.002)
    post = POST | {"position": [0.8, 0.6]}
    run = Simulation(scene_from_dict(given | {"body": [post]}))
    run.go()
    assert run.history.bodies["vy"].max() == pytest.approx(1.0, abs=0.05)


def test_a_law_between_bodies_of_a_source_leaves_others_alone() -> None:
    law = BOUNCE | {"names": ["grain*", "grain*"]}
    run = Simulation(scene_from_dict(tables(interaction=[law], sink=[], end=0.5)))
    run.go(0.1)
    assert list(run.bodies) == ["post", "grain0"]
    (interaction,) = run.system.interactions
    assert interaction.surfaces == ((1,), (1,))
    run.go()
    (interaction,) = run.system.interactions
    assert interaction.surfaces == ((1, 2, 3), (1, 2, 3))


def test_names_that_no_source_gives_are_refused() -> None:
    with pytest.raises(SceneError, match=r"interaction\.0\.names\.0.*'grin\*'.*'grain\*'"):
        scene_from_dict(tables(interaction=[BOUNCE | {"names": ["grin*"]}]))


def test_the_region_of_a_sink_is_read_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A grain in it leaves all the same, after another one has left."""
    read, region = [], {"type": "box", "lower": [0.0, 0.0], "upper": [1.0, 0.4]}
    run = Simulation(scene_from_dict(tables(sink=[{"region": region}])))

    def told(*arguments: Any) -> Any:
        read.append(arguments)
        return region_of(*arguments)

    monkeypatch.setattr("rigidfluid.core.case.sinks.region_of", told)
    run.go()
    assert (run.history.exchanges["change"] == "gone").sum() > 0
    assert run.state.count > 3
    assert len(read) == 1


def test_a_body_at_an_open_end_is_told_of_sinks() -> None:
    """It has passed the outlet when the next one of a source enters."""
    ends = [
        {"on": "left", "type": "velocity", "velocity": [1.0, 0.0]},
        {"on": "right", "type": "pressure", "pressure": 0.0},
    ]
    late = {"type": "box", "lower": [0.1, 0.3], "upper": [0.4, 0.9]}
    source = SOURCE | {"times": [0.0, 0.45], "region": late, "velocity": [2.0, 0.0]}
    post = {"name": "post", "type": "sphere", "radius": 0.05, "density": 1.0, "position": [0.5, 0.1], "fixed": True}
    run = Simulation(
        scene_from_dict(dry_tables(post, source=[source], boundary=ends, fluid={"gravity": [0.0, 0.0]}, end=1.0))
    )
    with pytest.raises(StepError, match=r"grain0.*let it leave before, by a \[\[sink\]\] with on = 'right'"):
        run.go()
