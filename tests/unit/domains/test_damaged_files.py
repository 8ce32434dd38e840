"""Files of others that are damaged, without end or too large are refused by name, whatever readers make of them."""

from __future__ import annotations

import os
import subprocess
import sys
import tracemalloc
from pathlib import Path
from typing import Any

import pytest

import rigidfluid
from rigidfluid.core.geometry.stl_file import read_stl
from rigidfluid.core.nested.rows import read_rows
from rigidfluid.domains import cad, mesh_file, trial
from rigidfluid.domains.cad import Cad, CadOptions
from rigidfluid.domains.mesh import MeshDomain, MeshOptions
from rigidfluid.errors import SceneError
from rigidfluid.regular_file import MOST_TEXT, require_regular

SECRET = "somebody:*:20228:0:99999:7:::"


@pytest.fixture
def drawn(tmp_path: Path) -> Path:
    """A cylinder as Open CASCADE writes it."""
    from netgen import occ

    path = tmp_path / "cylinder.brep"
    occ.Cylinder(occ.Pnt(0, 0, 0), occ.Z, 1.0, 4.0).WriteBrep(str(path))
    return path


def test_a_drawing_that_ends_its_reader_is_refused(drawn: Path) -> None:
    """Nine tenths of this file are a segmentation fault."""
    drawn.write_bytes(drawn.read_bytes()[: int(0.9 * drawn.stat().st_size)])
    with pytest.raises(SceneError, match=r"domain.file: found .*whose reading ended the process .*Segmentation"):
        Cad(CadOptions(file=str(drawn), faces={"wall": 1}), 3)


def test_files_of_the_working_folder_are_no_modules_of_a_trial(
    drawn: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "signal.py").write_text("import os\nos.abort()", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert Cad(CadOptions(file=str(drawn), faces={"wall": 1, "2": 2, "3": 3}), 3).volume > 0.0


@pytest.mark.long
def test_a_drawing_that_is_read_for_ever_is_refused(drawn: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """So is half of it."""
    monkeypatch.setattr(trial, "SECONDS", 10.0)
    drawn.write_bytes(drawn.read_bytes()[: drawn.stat().st_size // 2])
    with pytest.raises(SceneError, match=r"domain.file: found .*whose reading took more than 10 seconds"):
        Cad(CadOptions(file=str(drawn), faces={"wall": 1}), 3)


def test_a_whole_drawing_is_tried_once(drawn: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[Any] = []
    run = trial.subprocess.run
    monkeypatch.setattr(trial.subprocess, "run", lambda *args, **keys: (tried.append(args), run(*args, **keys))[1])
    for _ in range(2):
        assert Cad(CadOptions(file=str(drawn), faces={"wall": (1, 2, 3)}), 3).volume == pytest.approx(12.566370614)
    assert len(tried) == 1


def _read_again(*_: Any) -> Any:
    raise AssertionError("tried a second time")


def test_a_drawing_that_fails_its_reader_is_not_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A circle without end, which meshing would follow for ever."""
    from netgen import occ

    path = tmp_path / "disk.brep"
    occ.Circle((0.0, 0.0), 1.0).Face().WriteBrep(str(path))
    path.write_text(path.read_text().replace("6.28318530717959", "nan"))
    monkeypatch.setattr(cad, "_read", _read_again)
    with pytest.raises(SceneError, match=r"domain.file: found .*disk.brep, whose reading failed \(PluginError\)"):
        Cad(CadOptions(file=str(path), faces={"wall": 1}), 2)


def test_a_mesh_that_is_refused_by_its_trial_is_not_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "mesh.vol"
    path.write_text("mesh3d\ndimension\n2\nendmesh\n")
    monkeypatch.setattr(mesh_file, "read_untried", _read_again)
    with pytest.raises(SceneError, match=r"domain.file: found .*mesh.vol with 0 points in 2 dimensions; allowed is"):
        MeshDomain(MeshOptions(file=str(path)), 3)


@pytest.mark.parametrize("code", [1, 7, -11])
def test_only_a_trial_that_succeeds_lets_a_file_through(
    drawn: Path, monkeypatch: pytest.MonkeyPatch, code: int
) -> None:
    monkeypatch.setattr(trial.subprocess, "run", lambda *_, **__: subprocess.CompletedProcess([], code, b""))
    monkeypatch.setattr(cad, "_read", _read_again)
    with pytest.raises(SceneError, match=r"ended the process that tried it \((exit code \d|Segmentation)"):
        Cad(CadOptions(file=str(drawn), faces={"wall": (1, 2, 3)}), 3)


@pytest.mark.long
@pytest.mark.parametrize(
    "text",
    [
        "mesh3d\ndimension\n3\nsurfaceelements\n1\n 1 1 1 0 3 -5 900 7\nendmesh\n",
        "mesh3d\ndimension\n3\npoints\n999999999\n 0 0 0\nendmesh\n",
        "mesh3d\ndimension\n3\npoints\nmany\nendmesh\n",
    ],
)
def test_a_mesh_of_wrong_numbers_is_refused(tmp_path: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trial, "SECONDS", 10.0)
    path = tmp_path / "wrong.vol"
    path.write_text(text)
    with pytest.raises(SceneError, match=r"domain.file: found .*wrong.vol"):
        MeshDomain(MeshOptions(file=str(path)), 3)


@pytest.mark.parametrize("ending", [".msh", ".med", ".vtu", ".mesh", ".meshb", ".vol", ".vol.gz"])
def test_a_mesh_is_read_within_limits_whoever_reads_it(
    tmp_path: Path, ending: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trial, "SECONDS", 0.01)
    path = tmp_path / f"mesh{ending}"
    path.write_text("any")
    with pytest.raises(SceneError, match=r"domain.file: found .*whose reading took more than 0.01 seconds"):
        MeshDomain(MeshOptions(file=str(path)), 3)


@pytest.mark.parametrize(
    "text", ["$Comments\n", "$Nodes\n1\n1 1e300 0 0\n$EndNodes\n$Elements\n1\n1 1 2 1 1 1 1\n$EndElements\n"]
)
def test_a_mesh_without_points_or_with_huge_ones_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "wrong.msh"
    path.write_text(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{text}")
    with pytest.raises(
        SceneError, match=r"domain.file: found (.*wrong.msh without points|coordinates that are no such)"
    ):
        MeshDomain(MeshOptions(file=str(path)), 2)


@pytest.mark.skipif(sys.platform == "win32", reason="a process cannot be limited there")
def test_a_file_is_tried_where_memory_is_limited_already(drawn: Path) -> None:
    """Nine tenths of a file that ends its reader, under a limit of the shell below the one of trials."""
    drawn.write_bytes(drawn.read_bytes()[: int(0.9 * drawn.stat().st_size)])
    command = f"ulimit -v {1 << 22}; {sys.executable} -m rigidfluid.domains.trial cad {drawn} 3 {1 << 33}"
    ended = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False)
    assert "ValueError" not in ended.stderr
    assert ended.returncode not in (0, 1)


@pytest.mark.skipif(sys.platform == "win32", reason="there are neither pipes nor devices there")
@pytest.mark.parametrize("name", ["pipe", "/dev/zero", ""])
def test_only_regular_files_are_read(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    if name == "pipe":
        os.mkfifo(path)
    readers = [
        lambda: read_stl(path, "body.0.file"),
        lambda: read_rows(str(path), "body.0.prescribed"),
        lambda: rigidfluid.load_scene(path),
        lambda: MeshDomain(MeshOptions(file=str(path)), 3),
        lambda: Cad(CadOptions(file=str(path)), 3),
    ]
    for read in readers:
        with pytest.raises(SceneError, match=r"which is a (pipe or a device|folder); allowed is a regular file"):
            read()


def test_files_of_no_bounded_size_are_refused(tmp_path: Path) -> None:
    with (tmp_path / "large").open("wb") as file:
        file.truncate(MOST_TEXT + 1)  # holes take no room
    with pytest.raises(SceneError, match=r"scene: found .*large of 64 MiB; allowed is at most 64 MiB"):
        require_regular(tmp_path / "large", "scene", MOST_TEXT)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_text_of_triangles_is_read_in_a_few_times_its_size(tmp_path: Path, end: str) -> None:
    path = tmp_path / "many.stl"
    vertices = (f"vertex {n % 97}.25e+00 {n % 89}.5e+00 {n % 83}.75e+00" for n in range(30_000))
    path.write_bytes(end.join(["solid many", *vertices, "endsolid many"]).encode())
    tracemalloc.start()
    facets = read_stl(path, "body.0.file")
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(facets.vertices) == 10_000
    assert most < 8 * path.stat().st_size


@pytest.mark.parametrize("row", ["1 2", "1 2 3 4", "1 2 x"])
def test_a_vertex_has_three_numbers(tmp_path: Path, row: str) -> None:
    path = tmp_path / "wrong.stl"
    path.write_text("solid wrong\n" + "vertex 1 2 3\n" * 2 + f"vertex {row}\n")
    with pytest.raises(SceneError, match=r"wrong.stl, which is no STL file; allowed is three vertices a facet"):
        read_stl(path, "body.0.file")


@pytest.mark.parametrize("ending", ["csv", "stl", "toml", "brep", "vol"])
def test_no_refusal_quotes_a_file(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"shadow.{ending}"
    path.write_text(f"{SECRET}\nvertex {SECRET}\n")
    readers = {
        "csv": lambda: read_rows(str(path), "body.0.prescribed"),
        "stl": lambda: read_stl(path, "body.0.file"),
        "toml": lambda: rigidfluid.load_scene(path),
        "brep": lambda: Cad(CadOptions(file=str(path)), 3),
        "vol": lambda: MeshDomain(MeshOptions(file=str(path)), 3),
    }
    with pytest.raises(SceneError) as refused:
        readers[ending]()
    assert "somebody" not in str(refused.value)
    assert "20228" not in str(refused.value)
