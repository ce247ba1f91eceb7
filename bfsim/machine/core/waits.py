"""Waits that firmware has made: without `yield from`, a wait is never begun and does nothing.

The same holds for a stage without `with`. Stages, lines and rows are many, so they are checked only in a run's first picture.
"""

from __future__ import annotations

import contextlib
import inspect
from collections.abc import Callable, Generator
from functools import wraps
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar

from bfsim.errors import FirmwareError
from bfsim.machine.firmware_lines import running_line

Wait = Generator[Any, Any, Any]
"""Yields the events to wait for, one after the other."""


def name_of(wait: Wait) -> str:
    """Return the name of the generator function that made a wait."""
    return str(getattr(wait, "__name__", "a wait"))


class Waits:
    """The waits that one core's firmware has made since the last check."""

    def __init__(self, core: str) -> None:
        self._core = core
        self._made: list[tuple[Wait, str]] = []
        self._pictures = 0  # requested
        self.present: str | None = None
        """What the core waits for, in words, while only another device can end the wait."""

    def note(self, wait: Wait) -> None:
        """Note a wait that the firmware has just made. Before the next frame, all earlier waits must have begun."""
        if name_of(wait) == "next_frame":
            self.check()
            self._pictures += 1
        self._made.append((wait, running_line()))

    @property
    def are_all_noted(self) -> bool:
        """Whether stages, lines and rows are noted, too: until the second picture is requested."""
        return self._pictures < 2

    def noting(self, method: Callable[[], Wait]) -> Callable[[], Wait]:
        """Return `method`, wrapped so that each wait it makes is noted."""

        def made() -> Wait:
            wait = method()
            self.note(wait)
            return wait

        return made

    def check(self) -> None:
        """Raise FirmwareError if a wait was never begun."""
        if forgotten := self.forgotten():
            raise FirmwareError(f"{forgotten}; noticed")
        self._made.clear()

    def forgotten(self) -> str:
        """Say which wait was never begun, and where; empty if none."""
        for wait, place in self._made:
            if inspect.getgeneratorstate(wait) == inspect.GEN_CREATED:
                before = "with" if name_of(wait) == "stage" else "yield from"
                return f"core {self._core}: {name_of(wait)}(...) at {place} does nothing: write `{before}` before it"
        return ""


class HasWaits(Protocol):
    """An object that makes waits for the firmware of one core."""

    _waits: Waits
    """The waits of the core."""


Owner = TypeVar("Owner", bound=HasWaits)
Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")
Method = Callable[Concatenate[Owner, Arguments], Generator[Any, Any, Result]]


def awaited(method: Method[Owner, Arguments, Result]) -> Method[Owner, Arguments, Result]:
    """Decorate a method so that every wait it makes is noted."""

    @wraps(method)
    def made(
        self: Owner, /, *arguments: Arguments.args, **named: Arguments.kwargs
    ) -> Generator[Any, Any, Result]:
        wait = method(self, *arguments, **named)
        self._waits.note(wait)
        return wait

    return made


Stage = contextlib._GeneratorContextManager[None]  # noqa: SLF001  # what `contextmanager` makes; it has the generator
Named = Callable[[Owner, str], Stage]


def entered(method: Named[Owner]) -> Named[Owner]:
    """Decorate a method so that each stage it returns is noted in the first picture."""

    @wraps(method)
    def made(self: Owner, name: str) -> Stage:
        stage = method(self, name)
        if self._waits.are_all_noted:
            self._waits.note(stage.gen)
        return stage

    return made
