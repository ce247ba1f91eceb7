"""Sets of options for commands."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

Command = TypeVar("Command", bound=Callable[..., Any])


def takes(parameters: Iterable[Callable[[Any], Any]]) -> Callable[[Command], Command]:
    """Return the decorator that adds these click options and arguments to a command, in order."""

    def give(command: Command) -> Command:
        for parameter in reversed([*parameters]):
            command = parameter(command)
        return command

    return give
