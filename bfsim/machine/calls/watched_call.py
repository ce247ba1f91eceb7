"""Calls of kernels that others are told of before they run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.kernel import Kernel, Work
from bfsim.machine.memories import Row

BeforeCall = Callable[[Kernel, tuple[Row | int, ...]], None]
"""Is told of a kernel and its arguments before each call, and changes neither."""


class Sanitizer:
    """Runs each kernel as it is written before it is called, and undoes what that stored. Raises KernelError for a wrong index or divisor.

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
    """A call that others are told of before it runs."""

    run: Callable[..., Work]
    kernel: Kernel
    before: tuple[BeforeCall, ...]

    def __call__(self, *arguments: Row | int) -> Work:
        """Tell of the call, run the kernel, and say what it cost."""
        for tell in self.before:
            tell(self.kernel, arguments)
        return self.run(*arguments)
