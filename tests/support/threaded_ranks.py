"""Several ranks in one process, a thread for each."""

import pickle
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier, BrokenBarrierError

from rigidfluid.core.model.ranks import ROOT, Ranks


class ThreadedRanks(Ranks):
    """What the ranks hand each other goes through pickles, so that none sees another's arrays."""

    def __init__(self, rank, board):
        self.rank, self.size, self._board = rank, len(board.items), board

    def exchange(self, item):
        self._board.barrier.wait()
        self._board.items[self.rank] = pickle.dumps(item)
        self._board.barrier.wait()
        return [pickle.loads(each) for each in self._board.items]

    def gather(self, item):
        items = self.exchange(item)
        return items if self.is_root else None

    def bcast(self, item):
        return self.exchange(item if self.is_root else None)[ROOT]

    def scatter(self, items):
        return self.exchange(items)[ROOT][self.rank]

    def alltoall(self, items):
        return [theirs[self.rank] for theirs in self.exchange(items)]

    def abort(self):
        self._board.barrier.abort()

    def __reduce__(self):
        raise TypeError("ranks do not travel")


class _Board:
    def __init__(self, size):
        self.items, self.barrier = [None] * size, Barrier(size)


def on_ranks(size, work):
    """What ``work(ranks)`` gives on each of ``size`` ranks; where one fails, all end and its error is raised.

    The root works in the thread of the caller: libraries that mesh and factorise are at home there.
    """
    board, results, failures = _Board(size), [None] * size, []

    def one(rank):
        ranks = ThreadedRanks(rank, board)
        try:
            results[rank] = work(ranks)
        except BaseException as failure:  # noqa: BLE001
            failures.append(failure)
            ranks.abort()

    with ThreadPoolExecutor(size) as pool:
        for rank in range(1, size):
            pool.submit(one, rank)
        one(ROOT)
    if failures:
        raise min(failures, key=lambda failure: isinstance(failure, BrokenBarrierError))
    return results
