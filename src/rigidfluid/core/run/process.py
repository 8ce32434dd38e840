"""Processes of a run: how many a launcher has started, their signals, threads of the linear algebra, and memory."""

from __future__ import annotations

import ctypes
import gc
import os
import re
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

from rigidfluid.core.geometry.interrupts import is_interrupt

if TYPE_CHECKING:
    from rigidfluid.core.model.ranks import Ranks

_VARIABLES = (
    ("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"),  # Open MPI's mpirun
    ("PMI_RANK", "PMI_SIZE"),  # MPICH's and Intel's mpiexec (Hydra), and srun with PMI-2
    ("SLURM_PROCID", "SLURM_STEP_NUM_TASKS"),  # srun with PMIx; a batch script itself has no number of tasks of a step
)

_PATIENCE = 10.0


@dataclass(frozen=True, slots=True)
class Launch:
    """This process is number ``rank`` of ``size`` that were started together."""

    rank: int = 0
    size: int = 1

    @classmethod
    def read(cls, environment: Mapping[str, str] = os.environ) -> Launch:
        """Read the variables that the launcher has set; one process where none is found."""
        for rank, size in _VARIABLES:
            if rank in environment and size in environment:
                return cls(int(environment[rank]), int(environment[size]))
        return cls()

    def end(self) -> None:
        """End all processes at once, where this one cannot go on; the others would wait for it for ever."""
        if self.size > 1:
            try:
                from mpi4py import MPI
            except ImportError:
                return  # then nobody waits
            MPI.COMM_WORLD.Abort(1)

    def meet(self) -> None:
        """Wait for all processes, a few seconds at most: the launcher ends them all when the first one fails.

        The root may then not yet have said why.
        """
        if self.size > 1:
            try:
                from mpi4py import MPI
            except ImportError:
                return
            barrier, until = MPI.COMM_WORLD.Ibarrier(), time.monotonic() + _PATIENCE
            while not barrier.Test() and time.monotonic() < until:
                time.sleep(0.01)


@contextmanager
def no_collection() -> Iterator[None]:
    """Import libraries within, and search for garbage neither while they load nor among what they have made.

    They make some 500,000 objects that live as long as the process. Searching them again and again takes a tenth of
    the start.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


@contextmanager
def remembered_interrupt(ranks: Ranks) -> Iterator[Callable[[], None]]:
    """Make SIGTERM and SIGHUP within a KeyboardInterrupt as Ctrl-C is; give what raises that again where it was lost.

    Python ignores exceptions in finalisers and in what compiled code calls back. While numba compiles a loop, or loads
    one, an interrupt waits for its end: LLVM would end the process, or the loop would be lost for another reason.
    Several processes are all told, and end together at an exchange; a second Ctrl-C ends the one that gets it at once.
    SIGTERM is what mpirun makes of Ctrl-C, and what queues send when the time is up; SIGHUP is the end of a terminal.
    Only the main thread has signals, and other handlers than Python's own are left alone, as nohup's that ignores.
    """
    if threading.current_thread() is not threading.main_thread():
        yield ranks.heed_interrupts
        return
    pressed = False

    def remember(number: int, frame: FrameType | None) -> None:
        nonlocal pressed
        again, pressed = pressed, True
        if again or (ranks.size == 1 and not _is_compiling(frame)):
            signal.default_int_handler(number, frame)
        ranks.interrupt()

    def ask() -> None:
        ranks.heed_interrupts()
        if pressed and ranks.size == 1:
            raise KeyboardInterrupt

    ended = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    heard = [(signal.SIGINT, signal.default_int_handler), *((number, signal.SIG_DFL) for number in ended)]
    numbers = [number for number, own in heard if signal.getsignal(number) is own]
    before = {number: signal.signal(number, remember) for number in numbers}
    try:
        with _other_losses_told(), plain_interrupts():
            yield ask
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        ranks.forget_interrupts()


def _is_compiling(frame: FrameType | None) -> bool:
    """Tell whether numba compiles or loads a loop in a ``frame`` or one that has called it."""
    while frame is not None:
        if frame.f_globals.get("__name__") == "numba.core.dispatcher":
            return True
        frame = frame.f_back
    return False


@contextmanager
def plain_interrupts() -> Iterator[None]:
    """Raise an interrupt that came within compiled code as one: Python makes a SystemError of it."""
    try:
        yield
    except SystemError as error:
        if is_interrupt(error):
            raise KeyboardInterrupt from error
        raise


@contextmanager
def _other_losses_told() -> Iterator[None]:
    """Let Python tell of exceptions that it ignores, but for interrupts: those are remembered."""
    before = sys.unraisablehook

    def tell(lost: sys.UnraisableHookArgs) -> None:
        if lost.exc_type is not KeyboardInterrupt:
            before(lost)

    sys.unraisablehook = tell
    try:
        yield
    finally:
        sys.unraisablehook = before


class _SharedLimit:
    """One thread of OpenBLAS while any run of this process is within: set by the first, taken back by the last."""

    def __init__(self) -> None:
        self._lock, self._inside = threading.Lock(), 0
        self._limit: Any = None

    def __enter__(self) -> None:
        with self._lock:
            if self._inside == 0:
                self._limit = _openblas().limit(limits=1, user_api="blas")
            self._inside += 1

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._inside -= 1
            if self._inside == 0:
                self._limit.restore_original_limits()


_LIMIT = _SharedLimit()


def one_openblas_thread() -> AbstractContextManager[object]:
    """Keep OpenBLAS, which serves NumPy's and SciPy's short vectors, to one thread.

    Its idle threads spin, and take the cores from MKL and from everything else: with them a run of 7,000 unknowns took
    three times as long. One thread also makes sums repeatable to the last bit.
    """
    return _LIMIT


@cache
def _openblas() -> Any:
    """The libraries to be limited: NumPy's, and SciPy's own, which numba loads later if it is not loaded here."""
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController().select(internal_api="openblas")


_STATUS = Path("/proc/self/status")
_HIGHEST = re.compile(r"^VmHWM:\s*(\d+) kB$", re.MULTILINE)


def peak_memory() -> int | None:
    """Highest resident memory of this process until now [byte]; None where the system does not tell."""
    if sys.platform == "win32":
        return None
    return _program_peak() or _process_peak()


def give_back_memory() -> None:
    """Return what is free to the system, where the C library can.

    Arrays and factors of meshes of ever other sizes leave holes in its heap, which would grow with each new mesh.
    """
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None
    if trim is not None:
        trim(0)


def _program_peak() -> int | None:
    """Highest resident memory by Linux' own figures [byte]: those of `getrusage` count what the parent held when it
    started this process."""
    try:
        found = _HIGHEST.search(_STATUS.read_text(encoding="ascii"))
    except OSError:
        return None
    return int(found[1]) * 1024 if found else None


def _process_peak() -> int:
    import resource

    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
