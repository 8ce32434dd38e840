"""Keeps Python's signal handlers through calls of libraries that install their own."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_TAKEN_OVER = (signal.SIGINT, signal.SIGTERM, signal.SIGABRT, signal.SIGFPE, signal.SIGSEGV)


@contextmanager
def kept_signals() -> Iterator[None]:
    """Put the handlers back that MMG replaces and then resets to the default, under which Ctrl-C kills the interpreter.

    Only the main thread may set handlers; in another one nothing is done.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in _TAKEN_OVER}
    try:
        yield
    finally:
        for number, handler in before.items():
            if handler is not None:
                signal.signal(number, handler)
