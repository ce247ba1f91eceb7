"""A kernel as everybody knows it: what it is called, where it stands, what it takes and calls. What it does is a tree of its own."""

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

    `file`, `first_line` and `source` say where it stands, `names` what the names of its file mean.
    A kernel `is_static`, as C calls it, if other kernels of its file name it and nothing else there does: the file's main loops
    do not run it. Whether another file imports it is not looked at.
    `calls`: the kernels that it calls itself, each once, in source order. `written`: array parameters that it, or a kernel called
    by it, stores into; `measured`: those whose length is asked for, which comes with them in C. `digest`: of all that its code
    depends on but its callees. `read`: reads its body, which few runs need (`tree.body_of`).
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
