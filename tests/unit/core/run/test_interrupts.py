"""An interrupt that Python would lose is raised once more, and not told of as ignored."""

from __future__ import annotations

import signal
import sys

import pytest
from numba import njit
from numba.core.event import Event, Listener, install_listener

from rigidfluid.core.model.ranks import ALONE
from rigidfluid.core.run.process import remembered_interrupt
from rigidfluid.errors import SharedInterrupt


class Finalised:
    """Gets a signal while it is finalised."""

    def __del__(self) -> None:
        signal.raise_signal(signal.SIGINT)


def test_an_interrupt_in_a_finaliser_comes_later(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", told.append)
    with remembered_interrupt(ALONE) as interrupt_if_lost:
        interrupt_if_lost()
        Finalised()
        with pytest.raises(KeyboardInterrupt):
            interrupt_if_lost()
    assert not told
    assert sys.unraisablehook == told.append


class Impatient(Listener):
    """Sends a signal where numba begins to compile."""

    def on_start(self, event: Event) -> None:
        signal.raise_signal(signal.SIGINT)

    def on_end(self, event: Event) -> None:
        pass


def test_an_interrupt_while_a_loop_is_compiled_waits_for_its_end() -> None:
    @njit
    def doubled(number: float) -> float:
        return 2.0 * number

    with remembered_interrupt(ALONE) as interrupt_if_lost:
        with install_listener("numba:compile", Impatient()):
            assert doubled(1.0) == 2.0
        with pytest.raises(KeyboardInterrupt):
            interrupt_if_lost()


def test_a_second_interrupt_does_not_wait() -> None:
    @njit
    def halved(number: float) -> float:
        return 0.5 * number

    with (
        pytest.raises(KeyboardInterrupt),
        remembered_interrupt(ALONE),
        install_listener("numba:compile", Impatient()),
        install_listener("numba:compile", Impatient()),
    ):
        halved(1.0)
    try:
        ALONE.heed_interrupts()
    except SharedInterrupt:
        pytest.fail("the next run would be interrupted")


TWICE = SystemError("returned a result with an exception set")
TWICE.__cause__ = KeyboardInterrupt()


@pytest.mark.parametrize(
    ("cause", "told"),
    [(KeyboardInterrupt(), KeyboardInterrupt), (TWICE, KeyboardInterrupt), (ValueError(), SystemError)],
)
def test_an_interrupt_within_compiled_code_is_one(cause: BaseException, told: type[BaseException]) -> None:
    with pytest.raises(told), remembered_interrupt(ALONE):
        raise SystemError("returned a result with an exception set") from cause


class Faulty:
    """Fails while it is finalised."""

    def __del__(self) -> None:
        raise ValueError


def test_another_error_in_a_finaliser_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", told.append)
    with remembered_interrupt(ALONE):
        Faulty()
    assert len(told) == 1
