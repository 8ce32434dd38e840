"""A command that is interrupted within compiled code says so, and shows no traceback."""

from __future__ import annotations

import pytest
import typer

from rigidfluid.cli.console import INTERRUPTED, reported


def test_an_interrupt_within_compiled_code_is_no_fault(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(typer.Exit) as ended, reported("Nothing was written."):
        raise SystemError("returned a result with an exception set") from KeyboardInterrupt()
    assert ended.value.exit_code == INTERRUPTED
    assert capsys.readouterr().err == "Interrupted. Nothing was written.\n"


def test_another_error_within_compiled_code_is_one(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemError), reported("Nothing was written."):
        raise SystemError("returned a result with an exception set") from ValueError()
    assert "A fault" in capsys.readouterr().err
