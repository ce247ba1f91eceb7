"""Workers of a Dask scheduler that run points, on any number of machines."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import Any

from bfsim.errors import ConfigError, cut
from bfsim.files.save import write_bytes
from bfsim.report.check.baseline import Configuration
from bfsim.sweeping.running import Outcome, Work, code_digest, run_point_there

CONNECT_S = 10
QUEUED = 2
"""Calls under way for each thread of the workers: one that runs, and one that is ready when it ends."""


def _arrive(there: Future[tuple[Outcome, bytes]], here: Future[Outcome], work: Work | None) -> None:
    """Pass on the outcome of a point, after what it recorded; if that has no room, other points run in full."""
    if there.cancelled():
        here.cancel()
        here.set_running_or_notify_cancel()  # whoever waits for it is notified
    elif error := there.exception():
        here.set_exception(error)
    else:
        outcome, recorded = there.result()
        if work and recorded:
            with suppress(ConfigError):
                write_bytes(work.path, [recorded])
        here.set_result(outcome)


class Cluster(AbstractContextManager["Cluster"]):
    """The workers of a scheduler, including those that join while the sweep runs.

    Every worker must have this bfsim, and find the files under the same paths. If one dies, the scheduler gives its
    points to others.
    """

    def __init__(self, address: str, code: str) -> None:
        """Connect to workers whose bfsim has the digest `code`.

        Raises ConfigError if nobody answers, or if a worker has another bfsim.
        """
        try:
            from distributed import Client, KilledWorker
        except ImportError:
            raise ConfigError(
                "--scheduler must have Dask installed: pip install 'bfsim[sweep]'; without it, this machine alone runs them"
            ) from None
        self.deaths: tuple[type[Exception], ...] = (KilledWorker,)
        self.tries = 1
        """The scheduler itself tries often enough."""
        try:
            self._client = Client(address, timeout=CONNECT_S, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise ConfigError(
                f"--scheduler must be the address of a Dask scheduler that answers, such as tcp://10.0.0.1:8786, not "
                f"{cut(address)} ({cut(str(error))})"
            ) from None
        self._executor = self._client.get_executor(pure=False)
        self._works: dict[Path, Any] = {}
        try:
            self._require_code(code)
        except BaseException:
            self.__exit__()
            raise

    def room(self) -> int:
        """Return how many calls may be under way at a time: one even if there is no worker yet."""
        threads: dict[str, int] = self._client.nthreads()
        return max(QUEUED * sum(threads.values()), 1)

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Call a function on a worker."""
        future: Future[Any] = self._executor.submit(fn, *args)
        return future

    def run_point(
        self, configuration: Configuration, folder: Path, code: str, work: Work | None
    ) -> Future[Outcome]:
        """Call `running.run_point` on a worker; a recorded run is sent there or back."""
        played = self._sent(work.path) if work and work.seen is not None else None
        there = self.submit(run_point_there, configuration, folder, code, work, played)
        here: Future[Outcome] = Future()
        there.add_done_callback(lambda done: _arrive(done, here, work))
        return here

    def _sent(self, path: Path) -> Any:
        """Send a recorded run once to all present workers; return a reference to its content."""
        if path not in self._works:
            self._works = {known: content for known, content in self._works.items() if known.exists()}
            self._works[path] = self._client.scatter(path.read_bytes(), broadcast=True, hash=False)
        return self._works[path]

    def __exit__(self, *_: object) -> None:
        """Release the workers; one that is busy finishes its point, whose outcome is lost."""
        self._executor.shutdown(wait=False)
        self._client.close()

    def _require_code(self, code: str) -> None:
        """Raise ConfigError unless every worker has this bfsim; one that dies meanwhile does not matter."""
        answers = self._client.run(code_digest, on_error="return")
        for error in answers.values():
            if isinstance(error, Exception) and not isinstance(error, OSError):
                raise ConfigError(
                    f"every Dask worker must have this bfsim installed: {type(error).__name__}: {cut(str(error))}"
                ) from error
        others = [
            address for address, answer in answers.items() if isinstance(answer, str) and answer != code
        ]
        if others:
            raise ConfigError(
                f"every Dask worker must have the same bfsim as this machine, but {cut(', '.join(others))} has another"
            )
