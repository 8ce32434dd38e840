"""The command that makes pages: which it makes, what it says of those that fail, and of those out of date."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import make_validation
import page_tools.__main__ as one_page
import pytest
from page_tools import Page, Work


def command(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["make_validation.py", *words])
    return make_validation.main()


def test_a_page_that_fails_is_named_and_the_others_are_made(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[tuple[str, bool]] = []

    def make(name: str, fresh: bool) -> bool:
        asked.append((name, fresh))
        return name != "window"

    monkeypatch.setattr(make_validation, "make", make)
    assert command(monkeypatch, "window", "walls", "--fresh") == 1
    assert asked == [("window", True), ("walls", True)]
    assert capsys.readouterr().out == "could not be made: window\n"
    assert command(monkeypatch, "walls") == 0


def test_all_pages_are_made_where_none_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr(make_validation, "make", lambda name, _: not asked.append(name))
    assert command(monkeypatch) == 0
    assert asked == sorted(asked)
    assert {"falling_disk", "walls"} <= set(asked)


def test_a_page_that_is_not_there_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        command(monkeypatch, "windows")
    assert "no page windows; there are" in capsys.readouterr().err


def test_stale_pages_are_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(make_validation, "stale", lambda: iter([("walls", "1 of 2 inputs have changed: a.py")]))
    assert command(monkeypatch, "--stale") == 1
    assert capsys.readouterr().out == "walls: 1 of 2 inputs have changed: a.py\n"
    monkeypatch.setattr(make_validation, "stale", lambda: iter([]))
    assert command(monkeypatch, "--stale") == 0


@pytest.mark.parametrize("fails", [False, True])
def test_a_page_is_written_when_all_of_it_is_there(monkeypatch: pytest.MonkeyPatch, fails: bool) -> None:
    written: list[str] = []

    def page(work: Work) -> Page:
        if fails:
            raise ValueError
        return Page("Title", "Text.")

    monkeypatch.setitem(sys.modules, "pages.one", SimpleNamespace(page=page))
    monkeypatch.setattr(one_page, "write", lambda page, name, outdated: written.append(page.title))
    monkeypatch.setattr(one_page, "write_inputs", lambda name, inputs: written.append(name))
    if fails:
        with pytest.raises(ValueError):  # noqa: PT011
            one_page.main("one")
    else:
        one_page.main("one")
    assert written == ([] if fails else ["Title", "one"])
