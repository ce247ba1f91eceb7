"""Records that are made on demand: most runs are over before anyone asks for them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from typing import Any, TypeVar, overload

Record_co = TypeVar("Record_co", covariant=True)


class Later(Sequence[Record_co]):
    """A tuple of what `make` yields. `make` is called once, at first use."""

    def __init__(self, make: Callable[[], Iterable[Record_co]]) -> None:
        self._make = make

    @cached_property
    def _records(self) -> tuple[Record_co, ...]:
        records = tuple(self._make())
        del self._make  # and everything that it holds
        return records

    def __len__(self) -> int:
        return len(self._records)

    @overload
    def __getitem__(self, index: int) -> Record_co: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Record_co]: ...
    def __getitem__(self, index: int | slice) -> Record_co | Sequence[Record_co]:
        return self._records[index]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and self._records == tuple(other)

    def __hash__(self) -> int:
        return hash(self._records)

    def __repr__(self) -> str:
        return repr(self._records)

    def __reduce__(self) -> tuple[Any, ...]:
        return tuple, (self._records,)
