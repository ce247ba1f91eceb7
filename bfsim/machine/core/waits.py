"""Waits that firmware has made: without `yield from` before it a wait is never begun, and nothing happens.

So it is with a stage without `with`. Stages, lines and rows, of which there are many, are looked at in a run's first picture.
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
"""Gives the events that are waited for, one after the other."""


def name_of(wait: Wait) -> str:
    """Return the name of what made a wait."""
    return str(getattr(wait, "__name__", "a wait"))


class Waits:
    """What one core's firmware has asked to wait for, since this was looked at last."""

    def __init__(self, core: str) -> None:
        self._core = core
        self._made: list[tuple[Wait, str]] = []
        self._pictures = 0  # asked for
        self.present: str | None = None
        """What the core waits for, in words, while only another device can let it go on."""

    def note(self, wait: Wait) -> None:
        """Note a wait that the firmware has just made. Who asks for the next frame must have begun all before."""
        if name_of(wait) == "next_frame":
            self.check()
            self._pictures += 1
        self._made.append((wait, running_line()))

    @property
    def are_all_noted(self) -> bool:
        """Whether those that are many are noted, too: until the second picture is asked for."""
        return self._pictures < 2

    def noting(self, method: Callable[[], Wait]) -> Callable[[], Wait]:
        """Return what has each wait noted that `method` makes."""

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
    """What makes waits for the firmware of one core."""

    _waits: Waits
    """Those of the core."""


Owner = TypeVar("Owner", bound=HasWaits)
Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")
Method = Callable[Concatenate[Owner, Arguments], Generator[Any, Any, Result]]


def awaited(method: Method[Owner, Arguments, Result]) -> Method[Owner, Arguments, Result]:
    """Note every wait that this method makes."""

    @wraps(method)
    def made(
        self: Owner, /, *arguments: Arguments.args, **named: Arguments.kwargs
    ) -> Generator[Any, Any, Result]:
        wait = method(self, *arguments, **named)
        self._waits.note(wait)
        return wait

    return made


Stage = contextlib._GeneratorContextManager[None]  # noqa: SLF001  # what `contextmanager` makes, with its generator
Named = Callable[[Owner, str], Stage]


def entered(method: Named[Owner]) -> Named[Owner]:
    """Note each stage that this method gives, in the first picture."""

    @wraps(method)
    def made(self: Owner, name: str) -> Stage:
        stage = method(self, name)
        if self._waits.are_all_noted:
            self._waits.note(stage.gen)
        return stage

    return made
