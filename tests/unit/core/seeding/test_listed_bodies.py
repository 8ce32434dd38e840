"""Bodies of swarms from CSV files, and errors that name line and column."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from swarms import DISK, ELLIPSE, ELLIPSOID, radii, seeded, start

from rigidfluid.errors import SceneError

PLAIN = """# written by another program
x, y, radius, angle, vx, vy, w, name, density
0.2, 0.3, 0.05, 1.5, 1, -2, 3, first, 4

0.7, 0.3, 0.1, 0, 0, 0, 0, , 5
"""


def test_bodies_are_where_the_file_says(tmp_path: Path) -> None:
    (tmp_path / "bodies.csv").write_text(PLAIN)
    scene = seeded(2, DISK, file=str(tmp_path / "bodies.csv"))
    np.testing.assert_array_equal(start(scene).position, [[0.2, 0.3], [0.7, 0.3]])
    np.testing.assert_array_equal(start(scene).orientation, [[1.5], [0.0]])
    np.testing.assert_allclose(radii(scene), [0.05, 0.1])
    first, second = scene.body
    assert (first.name, second.name) == ("first", "grain1")
    assert (first.density, second.density) == (4.0, 5.0)
    assert (first.velocity, first.angular_velocity) == ((1.0, -2.0), (3.0,))
    record = scene.swarm[0].seeded
    assert record is not None
    assert record.way == "file"
    assert record.gap == pytest.approx(0.15)


def test_other_keys_give_the_rest_at_random(tmp_path: Path) -> None:
    (tmp_path / "bodies.csv").write_text("x,y,z,shape,size\n.2,.2,.2,1,.5\n.7,.7,.7,0,1\n")
    scene = seeded(
        3, DISK, ELLIPSOID, file=str(tmp_path / "bodies.csv"), velocity=[1.0, 0.0, 0.0], velocity_deviation=0.1
    )
    assert [body.type for body in scene.body] == ["ellipsoid", "sphere"]
    np.testing.assert_allclose(scene.body[0].options["semi_axes"], [0.06, 0.04, 0.03])
    assert scene.body[0].orientation is not None
    assert scene.body[1].orientation is None
    assert scene.body[0].velocity != scene.body[1].velocity


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("x,z\n1,2\n", "line 1, column 'z': found a key that nothing reads"),
        ("x,radius\n1,2\n", "line 1: found no column 'y'; allowed is the columns x, y together"),
        ("x,y,vx\n.1,.1,2\n", "line 1: found no column 'vy'"),
        ("x,y,x\n.1,.1,2\n", "line 1: found column 'x' twice"),
        ("x,y,size,radius\n.1,.1,1,1\n", "line 1: found columns 'size' and 'radius'"),
        ("\n# places\nx,y\n.1,.1\n.1\n", "line 5: found 1 values; allowed is 2"),
        ("x,y\n.1,one\n", "line 2, column 'y': found 'one'; allowed is a number"),
        ("x,y\n.1,inf\n", "line 2, column 'y': found 'inf'"),
        ("x,y,radius\n.1,.1,-1\n", "line 2, column 'radius': found '-1'; allowed is a number above 0"),
        ("x,y\n", "without bodies"),
        ("x,y,shape\n.1,.1,2\n", "column 'shape': found 2.0; allowed is a whole number from 0 to 1"),
        ("x,y\n.5,.5\n2,.5\n", "line 3: found a body at [2.0, 0.5] with a gap of -1.05 to another one or to a wall"),
        ("x,y,shape,radius\n.1,.1,1,1\n", "found a radius of a 'ellipsoid'"),
        ("x,y\n.1,.1\n.12,.1\n", "line 2: found a body at [0.1, 0.1] with a gap of -0.08 to another one or to a wall"),
    ],
)
def test_errors_name_line_and_column(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "bodies.csv").write_text(text)
    with pytest.raises(SceneError) as error:
        seeded(2, DISK, ELLIPSE | {"weight": 1e-9}, file=str(tmp_path / "bodies.csv"))
    assert told in str(error.value)


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"swarm\.0\.file.*No such file"):
        seeded(2, DISK, file=str(tmp_path / "bodies.csv"))
