"""A sweep: planning its points, finding results of earlier runs, and running the rest."""

from __future__ import annotations

import time
import uuid
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any, Protocol, TypeVar

from bfsim.checking import arguments_of
from bfsim.errors import ConfigError
from bfsim.process.signals import uninterrupted
from bfsim.report.check.baseline import Configuration
from bfsim.shipped import RECORDING
from bfsim.sweeping.file import Point, read_sweep
from bfsim.sweeping.planned import Planned, planned_point
from bfsim.sweeping.running import Outcome, Work, code_digest, digest_recording, plan_point, run_point
from bfsim.sweeping.store import Store, key_of
from bfsim.sweeping.works import Works
from bfsim.trace import Identity

POLL_S = 1.0
"""How often to ask whether another sweep has finished a point that it claimed."""

NOT_KEPT = (
    "not kept: the recording, or a file of the firmware, the board or the compiler, was changed while it ran, or the firmware "
    "imported one more"
)

GONE = (
    "the scheduler must be within reach until all points are done, but no longer is; finished points are kept, and the same "
    "command runs the rest"
)

Task = TypeVar("Task")


class Workers(Protocol):
    """What runs points. `deaths` are errors of a future whose process died; each point has this many `tries`."""

    deaths: tuple[type[Exception], ...]
    tries: int

    def room(self) -> int:
        """Return how many calls may be under way at a time."""

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Call a function in a worker."""

    def run_point(
        self, configuration: Configuration, folder: Path, code: str, work: Work | None
    ) -> Future[Outcome]:
        """Call `running.run_point` in a worker. What it records is at the path of `work` on this machine afterwards."""


class Sweep:
    """The points of a file, what is `planned` of them, and the `outcomes` of finished ones, by their keys."""

    def __init__(self, file: Path, store: Store) -> None:
        """Read the file, and check it by itself. Raises ConfigError."""
        self.file = file
        self.store = store
        self.points = read_sweep(file, store.scripts)
        store.open()
        self.planned: list[Planned] = []
        self.outcomes: dict[str, Outcome] = {}
        self._folder = file.absolute().parent

    @property
    def todo(self) -> list[Planned]:
        """Points that can run and are not finished, without duplicates."""
        points = {each.key: each for each in self.planned if each.key and each.key not in self.outcomes}
        return [*points.values()]

    def error_of(self, planned: Planned) -> str:
        """Return why a point cannot run, or failed; "" if neither."""
        outcome = self.outcomes.get(planned.key)
        return planned.error or (outcome.error if outcome else "")

    def plan(self, workers: Workers, tell: Callable[[int, int], None]) -> None:
        """Read and check everything that the points need, and find earlier results. Nothing is simulated.

        `tell` gets the number of points checked, and that of all.
        """
        found: dict[int, tuple[Identity, int] | str] = {}
        name = uuid.uuid4().hex
        calls = ((each, plan_point, (*self._call(point), name)) for each, point in enumerate(self.points))
        for number, future in _results(calls, workers):
            found[number] = (
                "the process that read it died"
                if isinstance(future.exception(), workers.deaths)
                else future.result()
            )
            tell(len(found), len(self.points))
        recordings = [self._recording(point) for point in self.points]
        digests = self._digests(
            {(recordings[each], known[1]) for each, known in found.items() if not isinstance(known, str)},
            workers,
        )
        self.planned = [
            planned_point(point, found[number], digests, recordings[number])
            for number, point in enumerate(self.points)
        ]
        keys = {each.key for each in self.planned if each.key}
        self.outcomes = {key: known for key in keys if (known := self.store.outcome(key))}

    def run(self, workers: Workers, tell: Callable[[Planned, Outcome], None]) -> None:
        """Run the unfinished points; each is stored, and then reported, as soon as it is finished.

        Points that another sweep is running in the same store are awaited, and reported as if they had run here.
        """
        waiting, tries = deque(self.todo), Counter[str]()
        running: dict[Future[Any], Planned] = {}
        with Works(self.store, waiting) as works:
            while waiting or running:
                waiting = deque(sorted(waiting, key=lambda each: works.is_expected(each.key)))
                for each in self._claimed(waiting, workers.room() - len(running)):
                    if known := self.store.outcome(each.key):
                        self._done(each, known, works, tell)
                    else:
                        call = (*self._call(each.point), code_digest(), works.order(each.key))
                        running[workers.run_point(*call)] = each
                if waiting and not running:
                    time.sleep(POLL_S)
                for future in wait(running, POLL_S, FIRST_COMPLETED).done if running else ():
                    each = running.pop(future)
                    outcome = _outcome(future, each, workers, tries)
                    if outcome is None:
                        self.store.release(each.key)
                        waiting.append(each)
                    else:
                        self._done(each, outcome, works, tell)

    def _claimed(self, waiting: deque[Planned], room: int) -> Iterator[Planned]:
        """Yield at most `room` points that this sweep can claim now; those of another sweep go to the end."""
        for _ in range(len(waiting)):
            if room <= 0:
                return
            each = waiting.popleft()
            if self.store.claim(each.key):
                room -= 1
                yield each
            else:
                waiting.append(each)

    def _done(
        self, planned: Planned, outcome: Outcome, works: Works, tell: Callable[[Planned, Outcome], None]
    ) -> None:
        with uninterrupted():  # a stored result must be in the table, too
            if outcome.is_final:
                self.store.keep(planned.key, outcome)
            works.done(planned.key, outcome)
            self.store.release(planned.key)
            self.outcomes[planned.key] = outcome
            tell(planned, outcome)

    def try_out(self, planned: Planned, frames: int, workers: Workers) -> Outcome:
        """Run the first frames of a point, twice, so that its kernels are compiled. Nothing is kept.

        If its process dies, nothing is learnt.
        """
        trial = replace(
            planned.point, configuration=planned.point.configuration.model_copy(update={"frames": frames})
        )
        try:
            for _ in range(2):
                outcome: Outcome = workers.submit(run_point, *self._call(trial), code_digest()).result()
        except workers.deaths:
            return Outcome(error="the process that tried it died", is_final=False)
        return outcome

    def _call(self, point: Point) -> tuple[Configuration, Path]:
        return point.configuration, self._folder

    def _recording(self, point: Point) -> Path:
        return Path(arguments_of(*self._call(point)).get("recording", RECORDING))

    def _digests(self, recordings: set[tuple[Path, int]], workers: Workers) -> dict[tuple[Path, int], str]:
        """Return the digests of the first frames of recordings; those known from before are in the store."""
        digests = {each: self.store.recording_digest(*each) for each in sorted(recordings)}
        unread = [each for each, digest in digests.items() if not digest]
        for each, future in _results(((each, digest_recording, each) for each in unread), workers):
            digests[each] = "" if isinstance(future.exception(), workers.deaths) else future.result()
            if digests[each]:
                self.store.keep_recording_digest(*each, digests[each])
        return digests


def _results(
    calls: Iterable[tuple[Task, Callable[..., Any], tuple[Any, ...]]], workers: Workers
) -> Iterator[tuple[Task, Future[Any]]]:
    """Make the calls, and yield their futures as they finish."""
    running: dict[Future[Any], Task] = {}
    calls = iter(calls)
    while True:
        for task, function, arguments in islice(calls, max(workers.room() - len(running), 0)):
            running[workers.submit(function, *arguments)] = task
        if not running:
            return
        for future in wait(running, return_when=FIRST_COMPLETED).done:
            yield running.pop(future), future


def _outcome(future: Future[Any], planned: Planned, workers: Workers, tries: Counter[str]) -> Outcome | None:
    """Return the outcome of a point; None if its process died and it is to be tried once more."""
    if future.cancelled():
        raise ConfigError(GONE)
    if isinstance(future.exception(), workers.deaths):
        tries[planned.key] += 1
        if tries[planned.key] < workers.tries:
            return None
        times = f" {workers.tries} times" if workers.tries > 1 else ""
        return Outcome(error=f"the process that ran it died{times}", is_final=False)
    outcome: Outcome = future.result()
    if outcome.identity and key_of(outcome.identity, code_digest()) != planned.key:
        return replace(outcome, warnings=(*outcome.warnings, NOT_KEPT), is_final=False)
    return outcome
