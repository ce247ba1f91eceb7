"""Kernel calls that are counted together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel import Kernel, Work
from bfsim.kernel.host_code.jit import CompiledKernel
from bfsim.kernel.ir.text import SourceLine
from bfsim.machine.bus.state import NO_BUFFER

if TYPE_CHECKING:
    from bfsim.kernel.objects.compiled import CompiledObject

Label = TypeVar("Label")


class Fetches(Protocol):
    """The fetches of code by calls that are counted together."""

    def behind(self, run: Callable[..., Work]) -> Callable[..., Work]:
        """Return a call that adds these fetches to its accesses, in the access trace."""


class GroupSite(NamedTuple):
    """A site where the calls of a group access memory: the path of calls to it, its line, and the owner of the memory."""

    path: tuple[str, ...]
    line: SourceLine
    owner: int


@dataclass(slots=True)
class CallGroup:
    """Calls of one kernel in one stage with its arrays in the same buffers.

    `owners` own each array's memory. `fetched` are routines with code outside L1, and `fetches` fetches it. `totals` are the events of
    each counter. In the core, they are numbered from `first_event` on, and the sites from `first_site` on.
    `subbanks` are the sub-banks of L1 in which the rows of each array have been.
    """

    stage: str
    kernel: Kernel
    owners: tuple[int, ...]
    fetched: tuple[str, ...]
    code: CompiledKernel | CompiledObject
    totals: NDArray[np.int64]
    first_event: int
    first_site: int
    subbanks: list[set[int]]
    fetches: Fetches | None = None

    @property
    def site_count(self) -> int:
        """Number of its sites."""
        return len(self.code.tables.site_routines) + len(self.fetched)

    def sites(self) -> Iterator[GroupSite]:
        """Yield the sites in order: those of its accesses, and one for the code of each fetched routine."""
        program, owner_of = self.code.program, self.by_array(self.owners)
        for path in program.paths:
            for site in program.own_sites[path.routines[-1]]:
                owner = owner_of.get(path.arrays.get(site.array, ""), NO_BUFFER)
                yield GroupSite(program.through(path, site.line), site.line, owner)
        for routine in self.fetched:
            path = next(each for each in program.paths if each.routines[-1] == routine)
            yield GroupSite(path.routines, SourceLine(routine, 1), NO_BUFFER)

    def by_array(self, labels: Sequence[Label]) -> dict[str, Label]:
        """Return the labels of the kernel's arrays by the arrays' names."""
        return dict(zip(self.kernel.function.array_names, labels, strict=True))
