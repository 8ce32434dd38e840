"""One attempt in a process of its own, with limits of time and memory, so that any end of it is told."""

from __future__ import annotations

import contextlib
import faulthandler
import multiprocessing
import os
import resource
import signal
import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from typing import Any

from rigidfluid.errors import RigidfluidError, RunWarning

FORK = multiprocessing.get_context("fork")
LONGEST = 1500
"""Characters of what an attempt said that are kept."""

REFUSED, FINISHED = "refused", "finished"


@dataclass(frozen=True)
class Limits:
    """The ``seconds`` and the ``memory`` [byte] that an attempt may take."""

    seconds: float
    memory: int


@dataclass(frozen=True)
class Ending:
    """How an attempt ended: ``how`` is `REFUSED`, `FINISHED`, or anything else; ``said`` its words, ``subject`` what
    a refusal is about."""

    how: str
    said: str = ""
    subject: str = ""


def ending_of(work: Callable[[], str]) -> Ending:
    """The ending of work that returns its own words; any error but a named one is raised."""
    try:
        return Ending(FINISHED, work())
    except RigidfluidError as error:
        return Ending(REFUSED, str(error), error.subject)


def contained(work: Callable[[], str], limits: Limits) -> Ending:
    """The ending of work in a child process, also where that is killed, hangs or raises what it should not."""
    receiver, sender = FORK.Pipe(duplex=False)
    child = FORK.Process(target=_attempt, args=(work, sender, limits))
    child.start()
    sender.close()
    said = _received(receiver, limits.seconds)
    if said is None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child.pid or 0, signal.SIGKILL)
    child.join()
    if said is None:
        return Ending("hang", f"no end within {limits.seconds:g} s")
    if said:
        return said
    code = child.exitcode or 0
    return Ending("death", signal.strsignal(-code) or "" if code < 0 else f"exit code {code}")


def _received(receiver: Connection, seconds: float) -> Any:
    """What a child sent; empty where it ended without a word, None where it did not end."""
    if not receiver.poll(seconds):
        return None
    try:
        return receiver.recv()
    except EOFError:
        return ""


def _attempt(work: Callable[[], str], sender: Connection, limits: Limits) -> None:
    faulthandler.disable()  # the parent tells how it ended
    os.setsid()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (limits.memory, resource.getrlimit(resource.RLIMIT_AS)[1]))
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, sys.stdout.fileno())
    os.dup2(null, sys.stderr.fileno())
    warnings.simplefilter("error")
    warnings.simplefilter("ignore", RunWarning)
    try:
        sender.send(_cut(ending_of(work)))
    except BaseException as error:
        sender.send(_cut(Ending(type(error).__name__, f"{error} {_place(error)}")))
        raise


def _cut(ending: Ending) -> Ending:
    return replace(ending, said=ending.said[:LONGEST])


def _place(error: BaseException) -> str:
    """Where an error was raised: the innermost lines of the program."""
    lines, trace = [], error.__traceback__
    while trace is not None:
        code = trace.tb_frame.f_code
        if "rigidfluid" in code.co_filename:
            lines.append(f"{code.co_filename.rpartition('rigidfluid/')[2]}:{trace.tb_lineno}")
        trace = trace.tb_next
    return f"({' '.join(lines[-4:])})"
