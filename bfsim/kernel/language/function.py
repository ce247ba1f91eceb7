"""A kernel as others see it: its name, its place, its parameters and its callees. What it does is in a separate tree."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

from bfsim.files.content import lines_of
from bfsim.kernel.types import ArrayType, Number


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a kernel."""

    name: str
    type: Number | ArrayType


@dataclass(frozen=True, eq=False)
class Function:
    """A whole kernel. `symbol` is its name in the machine code.

    `file`, `first_line` and `source` say where it stands; `names`: the meanings of the names in its file. A kernel
    `is_static`, in C's sense, if other kernels of its file name it and nothing else there does, so the file's main
    loops do not run it. Imports by other files do not count. `calls`: the kernels that it calls itself, each once, in
    source order. `written`: array parameters that it or its callees store into; `measured`: those whose length they ask
    for, which C passes along. `digest`: of all that its code depends on except its callees. `read`: reads its body,
    which few runs need (`tree.body_of`).
    """

    name: str
    symbol: str
    file: str
    first_line: int
    source: str
    names: Mapping[str, object]
    is_static: bool
    parameters: tuple[Parameter, ...]
    result: Number | None
    calls: tuple[Function, ...]
    written: frozenset[str]
    measured: frozenset[str]
    digest: str
    read: Callable[[], object]

    def __repr__(self) -> str:
        """Return the symbol alone, which stands for it in the text of a call."""
        return self.symbol

    @property
    def place(self) -> str:
        """Where it is defined, as file:line."""
        return f"{self.file}:{self.first_line}"

    @property
    def array_names(self) -> tuple[str, ...]:
        """Names of the parameters that are arrays."""
        return tuple(each.name for each in self.parameters if isinstance(each.type, ArrayType))

    @property
    def lines(self) -> list[str]:
        """Lines of its source."""
        return lines_of(self.source)

    def siblings(self) -> tuple[Function, ...]:
        """The other kernels of its file."""
        found = [getattr(each, "function", None) for each in self.names.values()]
        return tuple(
            each
            for each in found
            if isinstance(each, Function) and each.file == self.file and each is not self
        )

    def callees(self) -> tuple[Function, ...]:
        """Kernels that this one calls, directly or not, each once, callees first."""
        return _callees(self)


@cache
def _callees(function: Function) -> tuple[Function, ...]:
    found: dict[Function, None] = {}
    for each in function.calls:
        found.update(dict.fromkeys((*each.callees(), each)))
    return tuple(found)
