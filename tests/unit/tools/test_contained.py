"""Whatever end an attempt comes to, its parent is told of it."""

from __future__ import annotations

import os
import signal
import sys
import time

import pytest
from attacks.contained import FINISHED, REFUSED, Limits, contained

from rigidfluid.errors import SceneError

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there is no fork there")
LIMITS = Limits(seconds=60.0, memory=8 << 30)


def fail(error: BaseException) -> str:
    raise error


def test_a_result_and_a_refusal() -> None:
    assert contained(lambda: "done", LIMITS).how == FINISHED
    refused = contained(lambda: fail(SceneError("time.end", 1, "2", "Wait.")), LIMITS)
    assert (refused.how, refused.subject) == (REFUSED, "time.end")


def test_a_bare_exception() -> None:
    assert contained(lambda: fail(KeyError("x")), LIMITS).how == "KeyError"
    assert contained(lambda: fail(SystemExit(0)), LIMITS).how == "SystemExit"


def test_a_death() -> None:
    ending = contained(lambda: str(os.kill(os.getpid(), signal.SIGSEGV)), LIMITS)
    assert (ending.how, ending.said) == ("death", "Segmentation fault")
    assert contained(lambda: os._exit(0), LIMITS).how == "death"


def test_no_end() -> None:
    assert contained(lambda: str(time.sleep(600.0)), Limits(0.3, 8 << 30)).how == "hang"


def test_more_memory_than_there_is() -> None:
    assert contained(lambda: str(len(bytearray(9 << 30))), LIMITS).how == "MemoryError"
