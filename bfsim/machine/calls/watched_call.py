"""Calls of kernels with watchers that are told before each call."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.kernel import Kernel, Work
from bfsim.machine.memories import Row

BeforeCall = Callable[[Kernel, tuple[Row | int, ...]], None]
"""Called with a kernel and its arguments before each call. Changes neither."""


class Sanitizer:
    """Runs each kernel as written before its call, and undoes its stores. Raises KernelError for a wrong index or divisor.

    A kernel is prepared once for the same rows.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[Kernel, object], Callable[[Sequence[Any]], None]] = {}

    def __call__(self, kernel: Kernel, arguments: tuple[Row | int, ...]) -> None:
        """Run `kernel`."""
        kind = kernel, kernel.arrays_of(arguments)
        if kind not in self._known:
            rows = [arguments[each] for each in kernel.array_positions]
            self._known[kind] = kernel.sanitizer([each.array for each in rows if isinstance(each, Row)])
        self._known[kind](arguments)


@dataclass(frozen=True, slots=True)
class WatchedCall:
    """A call with functions that are called `before` it runs."""

    run: Callable[..., Work]
    kernel: Kernel
    before: tuple[BeforeCall, ...]

    def __call__(self, *arguments: Row | int) -> Work:
        """Tell the watchers, run the kernel, and return its cost."""
        for tell in self.before:
            tell(self.kernel, arguments)
        return self.run(*arguments)
