"""Calls of kernels that others are told of before they run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from bfsim.kernel import Kernel, Work
from bfsim.machine.memories import Row

BeforeCall = Callable[[Kernel, tuple[Row | int, ...]], None]
"""Is told of a kernel and its arguments before each call, and changes neither."""


def sanitize_call(kernel: Kernel, arguments: tuple[Row | int, ...]) -> None:
    """Run `kernel` as it is written, on copies. Raises KernelError for a wrong index or divisor."""
    kernel.sanitize([each.array if isinstance(each, Row) else each for each in arguments])


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
