"""Interrupts that come within compiled code."""

from __future__ import annotations


def is_interrupt(error: BaseException | None) -> bool:
    """Tell whether an error is an interrupt, of which Python makes a SystemError in each call of compiled code."""
    while isinstance(error, SystemError):
        error = error.__cause__
    return isinstance(error, KeyboardInterrupt)
