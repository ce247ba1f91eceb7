"""Whose cycles those of a frame are, kept small: a run of many frames has hundreds of owners in each, most of them with few numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import groupby
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from bfsim.trace import OwnerCost, StallReason

CALLS, ISSUE, IDLE, FIRST_STALL = range(4)
REASONS = tuple(StallReason)
COLUMNS = FIRST_STALL + len(REASONS)
"""What a row has of one owner in one stage: calls, issue and idle cycles, and stalls in the order of `StallReason`."""
COLUMN_OF = {reason: FIRST_STALL + number for number, reason in enumerate(REASONS)}

NUMBER = np.dtype([("owner", np.uint32), ("column", np.uint8), ("cclk", np.int64)])
"""A number that is not 0: of which owner, in which column."""


class Owner(NamedTuple):
    """An owner of cycles in a stage, named as in `trace.OwnerCost`."""

    stage: str
    name: str
    symbol: str = ""


@cache
def _shared(owners: tuple[Owner, ...]) -> tuple[Owner, ...]:
    """Return the first tuple that was equal: most frames have the same owners."""
    return owners


class OwnerCosts(Sequence[OwnerCost]):
    """The costs of owners, made from a table with a row of COLUMNS for each; rows of zeros are left out."""

    __slots__ = ("_numbers", "_owners")

    def __init__(self, owners: Sequence[Owner], table: NDArray[np.int64]) -> None:
        rows, columns = np.nonzero(table)
        is_first = np.ones(len(rows), np.bool_)  # of its row: they come in order
        is_first[1:] = rows[1:] != rows[:-1]
        self._owners = _shared(tuple(owners[each] for each in rows[is_first].tolist()))
        numbers = np.empty(len(rows), NUMBER)
        numbers["owner"] = np.cumsum(is_first) - 1
        numbers["column"], numbers["cclk"] = columns, table[rows, columns]
        self._numbers = numbers.tobytes()

    def __len__(self) -> int:
        return len(self._owners)

    def __iter__(self) -> Iterator[OwnerCost]:
        numbers = np.frombuffer(self._numbers, NUMBER).tolist()
        for row, group in groupby(numbers, key=lambda each: each[0]):
            yield _cost(self._owners[row], {column: number for _, column, number in group})

    @overload
    def __getitem__(self, index: int) -> OwnerCost: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[OwnerCost]: ...
    def __getitem__(self, index: int | slice) -> OwnerCost | Sequence[OwnerCost]:
        return tuple(self)[index]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]


def _cost(owner: Owner, numbers: dict[int, int]) -> OwnerCost:
    stalls = {REASONS[each - FIRST_STALL]: cclk for each, cclk in numbers.items() if each >= FIRST_STALL}
    return OwnerCost(
        stage=owner.stage,
        owner=owner.name,
        symbol=owner.symbol,
        calls=numbers.get(CALLS, 0),
        issue_cclk=numbers.get(ISSUE, 0),
        stall_cclk=dict(sorted(stalls.items())),
        idle_cclk=numbers.get(IDLE, 0),
    )
