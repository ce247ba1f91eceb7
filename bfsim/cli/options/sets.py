"""A set of options, given to a command at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

Command = TypeVar("Command", bound=Callable[..., Any])


def takes(parameters: Iterable[Callable[[Any], Any]]) -> Callable[[Command], Command]:
    """Return the decorator that gives a command these options and arguments of click's, in their order."""

    def give(command: Command) -> Command:
        for parameter in reversed([*parameters]):
            command = parameter(command)
        return command

    return give
