"""A process of a study with several at a time: runs what it is told on its standard input, until that is closed.

    python -m rigidfluid.post.studies.worker

reads pickled pairs of a subject and settings, and writes a pickled row for each.
"""

from __future__ import annotations

import os
import pickle
from queue import SimpleQueue
from threading import Thread
from typing import Any

from rigidfluid.post.studies.rows import try_run
from rigidfluid.post.studies.strict_table import Settings
from rigidfluid.post.studies.subject import Subject


def main() -> None:
    """Answer until there is nobody to answer."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print is no answer
    asked: SimpleQueue[tuple[Subject, Settings]] = SimpleQueue()
    Thread(target=_listen, args=(asked,), daemon=True).start()
    first: Any = None
    while True:
        subject, settings = asked.get()
        first = first or subject  # it knows which backends are warm
        pickle.dump(try_run(first, settings, lambda _: None), answers)
        answers.flush()


def _listen(asked: SimpleQueue[tuple[Subject, Settings]]) -> None:
    """Take what is asked; end this process, in the middle of a run too, where who asks has ended."""
    # sys.stdin has a lock that would abort a process that ends by an error
    with open(0, "rb", closefd=False) as questions:
        while True:
            try:
                asked.put(pickle.load(questions))
            except EOFError:
                os._exit(1)


if __name__ == "__main__":
    main()
