"""The command that makes pages: which it makes, what it says of those that fail, and of those out of date."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace

import make_validation
import page_tools.__main__ as one_page
import pytest
from page_tools import Page, Work
from page_tools.make import MEASURED, make, make_several, pages
from paths import ROOT


def command(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["make_validation.py", *words])
    return make_validation.main()


def test_a_page_that_fails_is_named_and_the_others_are_made(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[tuple[str, bool, bool]] = []

    def make(name: str, *, fresh: bool, present: bool) -> bool:
        asked.append((name, fresh, present))
        return name != "window"

    monkeypatch.setattr("page_tools.make.make", make)
    assert command(monkeypatch, "window", "walls", "--fresh") == 1
    assert sorted(asked) == [("walls", True, False), ("window", True, False)]
    assert capsys.readouterr().out == "could not be made: window\n"
    assert command(monkeypatch, "walls") == 0


def test_all_pages_are_made_where_none_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr("page_tools.make.make", lambda name, **_: not asked.append(name))
    assert command(monkeypatch) == 0
    assert sorted(asked) == pages()
    assert {"falling_disk", "walls", "tests", "step"} <= set(asked)
    assert asked[-len(MEASURED) - 1] == "tests"  # by the runs of others
    assert set(asked[-len(MEASURED) :]) == set(MEASURED)  # at last, alone


def test_pages_that_the_present_sources_have_made_are_left(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr("page_tools.make.make", lambda name, **_: not asked.append(name))
    present = SimpleNamespace(is_present=True), SimpleNamespace(is_present=False), None
    known = dict(zip(("walls", "window", "wakes"), present, strict=True))
    monkeypatch.setattr(make_validation, "read_record", known.__getitem__)
    assert command(monkeypatch, "--present", *known) == 0
    assert sorted(asked) == ["wakes", "window"]


def test_after_an_interrupt_no_page_is_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def interrupted(name: str) -> bool:
        asked.append(name)
        raise KeyboardInterrupt

    monkeypatch.setattr("page_tools.make.make", interrupted)
    with pytest.raises(KeyboardInterrupt):
        make_several([str(number) for number in range(100)])
    assert len(asked) < 50


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("walls", ["-m", "page_tools", "walls", "--fresh", "--present"]),
        ("step", ["benchmarks/step.py", "--page", "docs/validation/step.md"]),
    ],
)
def test_a_page_is_made_in_a_process_of_its_own(monkeypatch: pytest.MonkeyPatch, name: str, words: list[str]) -> None:
    run: list[tuple[list[str], dict[str, str]]] = []

    def started(command: list[str], *, cwd: Path, env: dict[str, str], check: bool) -> SimpleNamespace:
        run.append((command, env))
        return SimpleNamespace(returncode=0)

    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    monkeypatch.setattr("page_tools.make.commit", lambda: "1")
    monkeypatch.setattr("page_tools.make.subprocess.run", started)
    assert make(name, fresh=True, present=True)
    (command, environment), *_ = run
    assert [word.removeprefix(f"{ROOT}/") for word in command[1:]] == words
    assert environment["OMP_NUM_THREADS"] == "1"
    assert environment["PYTHONPATH"].startswith(str(ROOT / "src"))


def test_a_page_is_written_elsewhere_from_the_runs_of_the_repository_where_these_are_wanted(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    made: list[tuple[Path, Path, Path]] = []
    module = SimpleNamespace(page=lambda work: work)
    monkeypatch.setattr(one_page, "import_module", lambda _: module)
    monkeypatch.setattr(one_page, "write", lambda _, __, work, to: made.append((work.folder, work._rows, to)))
    one_page.main("walls", "--to", str(tmp_path))
    one_page.main("walls", "--to", str(tmp_path), "--kept")
    own = tmp_path / "runs" / "walls", tmp_path / "measured" / "walls.json", tmp_path
    assert made == [own, (ROOT / "out/validation/walls", ROOT / "docs/validation/measured/walls.json", tmp_path)]


def test_a_page_that_needs_dolfinx_is_made_where_there_is_some(monkeypatch: pytest.MonkeyPatch) -> None:
    run: list[list[str]] = []
    monkeypatch.setattr("page_tools.make.commit", lambda: "1")
    monkeypatch.setattr("page_tools.make.find_spec", lambda _: None)
    monkeypatch.setattr(
        "page_tools.make.subprocess.run", lambda command, **_: run.append(command) or SimpleNamespace(returncode=1)
    )
    assert not make("ten_cate")
    assert run[0][:3] == ["tools/dolfinx", "run", "python3"]


def test_what_quick_pages_say_else_is_told(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    found = {"walls": [], "lammps": ["- a\n+ b"]}
    monkeypatch.setattr(make_validation, "check", lambda names: [(name, found[name]) for name in names])
    assert command(monkeypatch, "--check", "walls") == 0
    assert capsys.readouterr().out == "walls: the same\n"
    assert command(monkeypatch, "--check", "walls", "lammps") == 1
    assert capsys.readouterr().out == "walls: the same\nlammps: 1 lines differ\n- a\n+ b\n"


def test_a_page_that_is_not_there_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        command(monkeypatch, "windows")
    assert "no page windows; there are" in capsys.readouterr().err


def test_stale_pages_are_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(make_validation, "stale", lambda names, _: [(name, "other results") for name in names[:1]])
    monkeypatch.setattr(make_validation, "unseen", lambda names: [(name, "made at 1") for name in names])
    assert command(monkeypatch, "--stale", "walls", "wakes") == 1
    unknown = "wakes: made at 1; of its results nothing is recorded\n"
    assert capsys.readouterr().out == f"walls: other results\n{unknown}"
    monkeypatch.setattr(make_validation, "stale", lambda names, _: [])
    assert command(monkeypatch, "--stale", "wakes") == 0
    assert capsys.readouterr().out == unknown


@pytest.mark.parametrize("fails", [False, True])
def test_a_page_is_written_when_all_of_it_is_there(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, fails: bool
) -> None:
    written: list[str] = []

    def page(work: Work) -> Page:
        if fails:
            raise ValueError
        return Page("Title", "Text.")

    monkeypatch.setitem(sys.modules, "pages.one", SimpleNamespace(page=page))
    monkeypatch.setattr(one_page, "write", lambda page, name, work, folder: written.append(page.title))
    words = ("one", "--to", str(tmp_path))
    if fails:
        with pytest.raises(ValueError):  # noqa: PT011
            one_page.main(*words)
    else:
        one_page.main(*words)
    assert written == ([] if fails else ["Title"])
