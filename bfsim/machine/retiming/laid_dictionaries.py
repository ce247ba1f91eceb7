"""The dictionaries of a frame, compiled: checked once, and unpacked where each operation and access finds its entry."""

from __future__ import annotations

from typing import Any

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.retiming.frame_words import (
    ACCESS_DICTIONARY_ROWS,
    DICTIONARIES_AT,
    ODD,
    OPERATION_DICTIONARY_ROWS,
    OWNERS,
    Words,
    at_column,
)
from bfsim.machine.retiming.packed_work import ACCESS_DICTIONARY, OPERATION_DICTIONARY, Views, number_at
from bfsim.machine.retiming.work import OPERATION_COLUMNS
from bfsim.machine.retiming.work_check import is_access_entry, is_operation

IN_L1 = -1
"""Stands for the begin of an owner's memory in L1: accesses to it are not logged."""
LOGGED, SITE = range(2)
"""Words of an entry of accesses: the log's entry for the first byte of the owner, or IN_L1; and the site."""
ACCESS_ENTRY_WORDS = 2


@native
def operation_entry_at(frame: Words, entry: int) -> int:
    """Return where the numbers of an entry of operations are."""
    return DICTIONARIES_AT + frame[ACCESS_DICTIONARY_ROWS] * ACCESS_ENTRY_WORDS + entry * OPERATION_COLUMNS


@native
def lay_operation_dictionary(frame: Words, views: Views) -> bool:
    """Unpack the dictionary of operations. Return whether all its entries can be played."""
    for column in range(OPERATION_COLUMNS):
        begin, width = at_column(frame, OPERATION_DICTIONARY + column)
        for number in range(frame[OPERATION_DICTIONARY_ROWS]):
            frame[operation_entry_at(frame, number) + column] = number_at(views, begin, width, number)
    for number in range(frame[OPERATION_DICTIONARY_ROWS]):
        at = operation_entry_at(frame, number)
        one = 0 if frame[at] == w.COPY else frame[at + 1]  # a difference between copies
        if not is_operation(frame[at], one, frame[at + 2], frame[at + 3], frame[at + 4]):
            return False
    return True


@native
def lay_access_dictionary(frame: Words, views: Views, firsts: Words) -> bool:
    """Unpack the dictionary of accesses. Return whether all its entries can be played."""
    (kinds, kind_width), (owners, owner_width) = (
        at_column(frame, ACCESS_DICTIONARY), at_column(frame, ACCESS_DICTIONARY + 1),
    )  # fmt: skip
    sites, site_width = at_column(frame, ACCESS_DICTIONARY + 2)
    for number in range(frame[ACCESS_DICTIONARY_ROWS]):
        kind, owner = (
            number_at(views, kinds, kind_width, number), number_at(views, owners, owner_width, number),
        )  # fmt: skip
        site = number_at(views, sites, site_width, number)
        if not is_access_entry(kind, site) or not 0 <= owner < frame[OWNERS]:
            return False
        entry = DICTIONARIES_AT + number * ACCESS_ENTRY_WORDS
        frame[entry + LOGGED] = IN_L1 if firsts[owner] == IN_L1 else kind << log.KIND_BIT | firsts[owner]
        frame[entry + SITE] = site
    return True


@native_entry("int64", "int64*", "int8*", "int16*", "int32*", "int64*", "int64*")
def lay_dictionaries(
    frame_at: Any, octets_at: Any, halves_at: Any, words_in_at: Any, longs_at: Any, firsts_at: Any
) -> int:
    """Unpack the dictionaries of a frame where `write_stretch` finds them. Return 0, or ODD.

    The arrays are those of `write_stretch`, and where the memory of each owner begins, or IN_L1.
    """
    frame = words_at(frame_at)
    views = words_at(octets_at), words_at(halves_at), words_at(words_in_at), words_at(longs_at)
    if not lay_operation_dictionary(frame, views):
        return ODD
    return 0 if lay_access_dictionary(frame, views, words_at(firsts_at)) else ODD
