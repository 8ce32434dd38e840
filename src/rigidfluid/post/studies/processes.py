"""Several runs at a time, each in a process of its own with one thread."""

from __future__ import annotations

import os
import pickle
import subprocess
from collections.abc import Generator, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import ExitStack, suppress
from queue import SimpleQueue
from tempfile import TemporaryFile
from threading import Lock
from typing import IO

from rigidfluid.errors import ArgumentError
from rigidfluid.post.studies.rows import Row
from rigidfluid.post.studies.strict_table import Settings
from rigidfluid.post.studies.subject import Subject
from rigidfluid.python_process import ONE_THREAD, environment, failure, python

MOST_JOBS = 4 * (os.cpu_count() or 1)
"""Largest number of processes: four for each processor, beyond which they only take each other's memory."""


def require_jobs(jobs: int) -> None:
    """Raise ArgumentError for a number of processes that is none, or too large for this machine."""
    if not 1 <= jobs <= MOST_JOBS:
        allowed = f"1 to {MOST_JOBS} on this machine"
        raise ArgumentError("jobs (-j)", jobs, allowed, "Take as many as it has processors.")


def run_apart(subject: Subject, runs: Mapping[str, Settings], jobs: int) -> Generator[tuple[str, Row], None, None]:
    """Run settings in processes, and yield rows by their fingerprints as they come; closing it ends the processes."""
    idle: SimpleQueue[_Worker] = SimpleQueue()
    with ExitStack() as after, ThreadPoolExecutor(jobs) as threads:
        workers = [_Worker(subject, after.enter_context(TemporaryFile())) for _ in range(min(jobs, len(runs)))]
        for worker in workers:
            after.callback(worker.close)
            idle.put(worker)
        waiting = {threads.submit(_run_idle, idle, settings): key for key, settings in runs.items()}
        try:
            for done in as_completed(waiting):
                yield waiting[done], done.result()
        finally:
            for each in waiting:
                each.cancel()
            for worker in workers:
                worker.end()


def _run_idle(idle: SimpleQueue[_Worker], settings: Settings) -> Row:
    worker = idle.get()
    try:
        return worker.run(settings)
    finally:
        idle.put(worker)


class _Worker:
    """A process that runs a subject with one setting after the other; another one takes the place of one that ended.

    Its standard error is in the file ``said``.
    """

    def __init__(self, subject: Subject, said: IO[bytes]) -> None:
        self._subject = subject
        self._said = said
        self._lock = Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._has_ended = False

    def run(self, settings: Settings) -> Row:
        """The row of one run; where its process ends, why it did."""
        with self._lock:
            if self._has_ended:
                return Row(None, "interrupted")
            process = self._process = self._process or _start(self._said)
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            pickle.dump((self._subject, settings), process.stdin)
            process.stdin.flush()
            row: Row = pickle.load(process.stdout)
        except (EOFError, OSError, pickle.UnpicklingError):
            return Row(None, self._failure(process))
        return row

    def end(self) -> None:
        """End the process, and start no other."""
        with self._lock:
            self._has_ended = True
            if self._process is not None:
                self._process.kill()

    def close(self) -> None:
        """Wait for the end of the process."""
        if self._process is not None:
            with suppress(OSError), self._process:  # it may not have read all
                pass

    def _failure(self, process: subprocess.Popen[bytes]) -> str:
        with suppress(OSError), process:
            pass
        self._process = None
        self._said.seek(0)
        return failure(process.returncode, self._said.read().decode("utf-8", errors="replace"))


def _start(said: IO[bytes]) -> subprocess.Popen[bytes]:
    said.seek(0)
    said.truncate()
    return subprocess.Popen(
        python("-m", "rigidfluid.post.studies.worker"),
        env=environment() | ONE_THREAD,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=said,
        start_new_session=True,  # Ctrl-C is for us, who end it
    )
