"""The processes that share one run: each holds a part of the mesh and of the fields, and all step together."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import NoneType
from typing import Any, TypeVar, final

import numpy as np

from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.errors import PluginError, RigidfluidError, SharedInterrupt

T = TypeVar("T")
ROOT = 0
"""The rank that meshes, and writes what is there once."""


class Ranks(ABC):
    """Processes that run the same loop; every method but `interrupt`, `forget_interrupts` and `abort` is called by
    all of them together.

    ``rank`` is this one's number, from 0 to ``size`` - 1.
    """

    rank: int
    size: int
    _is_interrupted = False

    @property
    def is_root(self) -> bool:
        """Tell whether this process meshes, and writes what is there once."""
        return self.rank == ROOT

    def interrupt(self) -> None:
        """Have all raise SharedInterrupt at their next `allgather`; safe to call from a signal's handler."""
        self._is_interrupted = True

    def forget_interrupts(self) -> None:
        """Let a run that has ended interrupt no later one."""
        self._is_interrupted = False

    @final
    def allgather(self, item: T) -> list[T]:
        """Everyone's ``item``, in the order of ranks, for all; raises SharedInterrupt where one was interrupted."""
        pairs = self.exchange((item, self._is_interrupted))
        if any(interrupted for _, interrupted in pairs):
            self._is_interrupted = False  # what is still to be told needs exchanges
            raise SharedInterrupt
        return [each for each, _ in pairs]

    @final
    def heed_interrupts(self) -> None:
        """Raise SharedInterrupt on all where one was interrupted."""
        self.allgather(None)

    @abstractmethod
    def exchange(self, item: T) -> list[T]:
        """Everyone's ``item``, in the order of ranks, for all, whoever was interrupted."""

    @abstractmethod
    def gather(self, item: T) -> list[T] | None:
        """Everyone's ``item``, in the order of ranks, for the root; None for the others."""

    @abstractmethod
    def bcast(self, item: T) -> T:
        """The root's ``item``, for all."""

    @abstractmethod
    def scatter(self, items: Sequence[T] | None) -> T:
        """This rank's one of the root's ``items``, one for each rank; the others pass None."""

    @abstractmethod
    def alltoall(self, items: Sequence[T]) -> list[T]:
        """``items`` has one for each rank; what the ranks have for this one, in their order."""

    @abstractmethod
    def abort(self) -> None:
        """End all processes at once, where one of them cannot go on and the others would wait for it for ever."""

    def sum(self, value: Any) -> Any:
        """Sum of everyone's ``value``, a number or an array; the same bits for all."""
        return np.sum(self.allgather(value), axis=0)

    def min(self, value: Any) -> Any:
        """The smallest of everyone's ``value``, element by element."""
        return np.min(self.allgather(value), axis=0)

    def greatest(self, value: Any) -> Any:
        """The largest of everyone's ``value``, element by element."""
        return np.max(self.allgather(value), axis=0)

    @contextmanager
    def raise_on_all(self) -> Iterator[None]:
        """An error on one rank becomes the same error on all, so that nobody waits for one who has left."""
        error: RigidfluidError | None = None
        try:
            yield
        except RigidfluidError as raised:
            cause = raised.__cause__
            if self.size > 1 and isinstance(raised, PluginError) and not isinstance(cause, Wrong | NoneType):
                cause.add_note(str(raised))  # in midst of what a part does, others may wait for this rank
                raise cause from None
            error = raised
        first = next((each for each in self.allgather(error) if each is not None), None)
        if error is not None:
            raise error
        if first is not None:
            raise first


class Alone(Ranks):
    """Single process that holds everything."""

    rank = 0
    size = 1

    def exchange(self, item: T) -> list[T]:
        return [item]

    def gather(self, item: T) -> list[T] | None:
        return [item]

    def bcast(self, item: T) -> T:
        return item

    def scatter(self, items: Sequence[T] | None) -> T:
        assert items is not None
        return items[0]

    def alltoall(self, items: Sequence[T]) -> list[T]:
        return list(items)

    def abort(self) -> None:
        """Nobody waits."""

    @contextmanager
    def raise_on_all(self) -> Iterator[None]:
        """Nothing to agree on."""
        yield


ALONE = Alone()


class MpiRanks(Ranks):
    """Processes of an MPI ``communicator``, an mpi4py.MPI.Intracomm."""

    def __init__(self, communicator: Any) -> None:
        self.communicator = communicator
        self.rank: int = communicator.rank
        self.size: int = communicator.size

    def exchange(self, item: T) -> list[T]:
        return list(self.communicator.allgather(item))

    def gather(self, item: T) -> list[T] | None:
        items: list[T] | None = self.communicator.gather(item, root=ROOT)
        return items

    def bcast(self, item: T) -> T:
        held: T = self.communicator.bcast(item, root=ROOT)
        return held

    def scatter(self, items: Sequence[T] | None) -> T:
        own: T = self.communicator.scatter(items, root=ROOT)
        return own

    def alltoall(self, items: Sequence[T]) -> list[T]:
        return list(self.communicator.alltoall(list(items)))

    def abort(self) -> None:
        self.communicator.Abort(1)
