"""Whose cycles those of a frame are, kept small: a run of many frames has hundreds of owners in each, most of them with few numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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


class Owner(NamedTuple):
    """An owner of cycles in a stage, named as in `trace.OwnerCost`."""

    stage: str
    name: str
    symbol: str = ""


class OwnerCosts(Sequence[OwnerCost]):
    """The costs of owners, made from a table with a row of COLUMNS for each; rows of zeros are left out."""

    __slots__ = ("_amounts", "_owners", "_places")

    def __init__(self, owners: tuple[Owner, ...], table: NDArray[np.int64]) -> None:
        """`owners`: best the same tuple for as many frames as have the same."""
        numbers = table.reshape(-1)
        (places,) = numbers.nonzero()
        self._owners = owners
        self._places, self._amounts = places.astype(np.uint32).tobytes(), numbers[places].tobytes()

    def __len__(self) -> int:
        return len(np.unique(self._rows_and_columns()[0]))

    def __iter__(self) -> Iterator[OwnerCost]:
        rows, columns = (each.tolist() for each in self._rows_and_columns())
        numbers = zip(rows, columns, np.frombuffer(self._amounts, np.int64).tolist(), strict=True)
        for row, group in groupby(numbers, key=lambda each: each[0]):
            yield _cost(self._owners[row], {column: number for _, column, number in group})

    def _rows_and_columns(self) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
        """Return where in the table each number is that is not 0: they come in order."""
        rows, columns = np.divmod(np.frombuffer(self._places, np.uint32), np.uint32(COLUMNS))
        return rows, columns

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
