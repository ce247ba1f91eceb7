"""The owners of a frame's cycles, stored compactly: each frame of a run has hundreds of owners, most of them with few numbers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import NamedTuple, Self, overload

import numpy as np
from numpy.typing import NDArray

from bfsim.trace.frames import OwnerCost, StallReason

CALLS, ISSUE, IDLE, FIRST_STALL = range(4)
REASONS = tuple(StallReason)
COLUMNS = FIRST_STALL + len(REASONS)
"""Numbers in the row of one owner in one stage: calls, issue and idle cycles, and stalls in the order of `StallReason`."""
COLUMN_OF = {reason: FIRST_STALL + number for number, reason in enumerate(REASONS)}


class Owner(NamedTuple):
    """An owner of cycles in a stage, named as in `trace.OwnerCost`."""

    stage: str
    name: str
    symbol: str = ""


class OwnerCosts(Sequence[OwnerCost]):
    """The costs of owners, made from a table with a row of COLUMNS for each. Rows of zeros are left out."""

    __slots__ = ("_amounts", "_places", "owners")

    def __init__(self, owners: tuple[Owner, ...], table: NDArray[np.int64]) -> None:
        """`owners` of the rows, ideally the same tuple for all frames with the same owners."""
        numbers = table.reshape(-1)
        (places,) = numbers.nonzero()
        self.owners = owners
        self._places, self._amounts = places.astype(np.uint32).tobytes(), numbers[places].tobytes()

    @classmethod
    def of(cls, costs: Sequence[OwnerCost]) -> Self:
        """Return costs in this form."""
        if isinstance(costs, cls):
            return costs
        owners = tuple(Owner(each.stage, each.owner, each.symbol) for each in costs)
        return cls(owners, np.array([_row(each) for each in costs], np.int64))

    def __len__(self) -> int:
        return len(np.unique(self.numbers()[0]))

    def __iter__(self) -> Iterator[OwnerCost]:
        for row, group in groupby(
            zip(*(each.tolist() for each in self.numbers()), strict=True), lambda each: each[0]
        ):
            yield _cost(self.owners[row], {column: number for _, column, number in group})

    def numbers(self) -> tuple[NDArray[np.uint32], NDArray[np.uint32], NDArray[np.int64]]:
        """Return row, column and amount of each non-zero number in the table, in order."""
        rows, columns = np.divmod(np.frombuffer(self._places, np.uint32), np.uint32(COLUMNS))
        return rows, columns, np.frombuffer(self._amounts, np.int64)

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


def _row(cost: OwnerCost) -> list[int]:
    return [cost.calls, cost.issue_cclk, cost.idle_cclk, *(cost.stall_cclk.get(each, 0) for each in REASONS)]


class OwnerNumbers:
    """A number for each owner of some costs, in order of appearance."""

    def __init__(self) -> None:
        self.owners: dict[Owner, int] = {}
        self._known: dict[
            int, tuple[tuple[Owner, ...], NDArray[np.int64]]
        ] = {}  # by the identity of a tuple of owners

    def of(self, costs: OwnerCosts) -> NDArray[np.int64]:
        """Return the owner's number for each number of `costs`."""
        owners = costs.owners
        _, numbers = self._known.setdefault(id(owners), (owners, np.full(len(owners), -1)))
        rows, _, _ = costs.numbers()
        for row in np.unique(rows[numbers[rows] < 0]).tolist():
            numbers[row] = self.owners.setdefault(owners[row], len(self.owners))
        return numbers[rows]


def sum_of_owners(costs: Iterable[Sequence[OwnerCost]]) -> OwnerCosts:
    """Return the sum of all costs, by owner."""
    numbers = OwnerNumbers()
    parts = [(numbers.of(each), *each.numbers()[1:]) for each in map(OwnerCosts.of, costs)]
    table = np.zeros((len(numbers.owners), COLUMNS), np.int64)
    for rows, columns, amounts in parts:
        np.add.at(table, (rows, columns), amounts)
    return OwnerCosts(tuple(numbers.owners), table)
