"""The sorts of a frame, compiled: checked once, and laid where each operation and access of that sort finds its numbers."""

from __future__ import annotations

from typing import Any

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.retiming.frame_words import (
    ACCESS_SORT_ROWS,
    ODD,
    OPERATION_SORT_ROWS,
    OWNERS,
    SORTS_AT,
    Words,
    at_column,
)
from bfsim.machine.retiming.packed_work import ACCESS_SORTS, OPERATION_SORTS, Views, number_at
from bfsim.machine.retiming.work import OPERATION_COLUMNS
from bfsim.machine.retiming.work_check import is_operation, is_sort

IN_L1 = -1
"""Where an owner begins whose memory is in L1: what accesses it is not in the log."""
ENTRY, SITE = range(2)
"""Words of a sort of accesses: what the log has of one to the first byte of its owner, IN_L1 if that is there; and the site."""
ACCESS_SORT_WORDS = 2


@native
def operation_sort_at(frame: Words, sort: int) -> int:
    """Return where the numbers of a sort of operations stand."""
    return SORTS_AT + frame[ACCESS_SORT_ROWS] * ACCESS_SORT_WORDS + sort * OPERATION_COLUMNS


@native
def lay_operation_sorts(frame: Words, views: Views) -> bool:
    """Lay the sorts of operations; return whether these are such as can be played."""
    for column in range(OPERATION_COLUMNS):
        begin, width = at_column(frame, OPERATION_SORTS + column)
        for number in range(frame[OPERATION_SORT_ROWS]):
            frame[operation_sort_at(frame, number) + column] = number_at(views, begin, width, number)
    for number in range(frame[OPERATION_SORT_ROWS]):
        at = operation_sort_at(frame, number)
        one = 0 if frame[at] == w.COPY else frame[at + 1]  # from one copy to the next
        if not is_operation(frame[at], one, frame[at + 2], frame[at + 3], frame[at + 4]):
            return False
    return True


@native
def lay_access_sorts(frame: Words, views: Views, firsts: Words) -> bool:
    """Lay the sorts of accesses; return whether these are such as can be played."""
    (kinds, kind_width), (owners, owner_width) = (
        at_column(frame, ACCESS_SORTS), at_column(frame, ACCESS_SORTS + 1),
    )  # fmt: skip
    sites, site_width = at_column(frame, ACCESS_SORTS + 2)
    for number in range(frame[ACCESS_SORT_ROWS]):
        kind, owner = (
            number_at(views, kinds, kind_width, number), number_at(views, owners, owner_width, number),
        )  # fmt: skip
        site, sort = number_at(views, sites, site_width, number), SORTS_AT + number * ACCESS_SORT_WORDS
        if not is_sort(kind, site) or not 0 <= owner < frame[OWNERS]:
            return False
        frame[sort + ENTRY] = IN_L1 if firsts[owner] == IN_L1 else kind << log.KIND_BIT | firsts[owner]
        frame[sort + SITE] = site
    return True


@native_entry("int64", "int64*", "int8*", "int16*", "int32*", "int64*", "int64*")
def lay_sorts(
    frame_at: Any, octets_at: Any, halves_at: Any, words_in_at: Any, longs_at: Any, firsts_at: Any
) -> int:
    """Lay the sorts of a frame where `write_stretch` finds them; return 0, or ODD.

    The arrays: those of `write_stretch`; and where the memory of each owner begins, or IN_L1.
    """
    frame = words_at(frame_at)
    views = words_at(octets_at), words_at(halves_at), words_at(words_in_at), words_at(longs_at)
    is_sound = lay_operation_sorts(frame, views) and lay_access_sorts(frame, views, words_at(firsts_at))
    return 0 if is_sound else ODD
