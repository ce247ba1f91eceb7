"""A thread for slow work that nobody waits for: it does one thing after the other while a run goes on."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Self

MOST = 3
"""The most things that wait their turn, since their inputs stay in memory."""


class Behind:
    """A context manager; an error in the thread is raised at the next request, or at `finish`."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1)
        self._asked: deque[Future[None]] = deque()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._thread.shutdown(cancel_futures=True)

    def do(self, what: Callable[[], None]) -> None:
        """Have `what` done after all earlier requests; wait if there are too many."""
        self._asked.append(self._thread.submit(what))
        while self._asked[0].done() or len(self._asked) > MOST:
            self._asked.popleft().result()
            if not self._asked:
                return

    def finish(self) -> None:
        """Wait until everything is done."""
        while self._asked:
            self._asked.popleft().result()
