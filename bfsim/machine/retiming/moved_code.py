"""Code outside of L1 that lies elsewhere than where a run was recorded: it is fetched from where it lies now."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from bfsim.kernel import access_trace as log
from bfsim.machine.retiming.work import BYTE, KIND, OWNER, Accesses, Table

CodePlace = Sequence[Any]
"""Core and name of a routine, the owner of its memory by number, and its place there."""
OWNER_BIT = log.OFFSET_MASK.bit_length()
"""Owner and place are one number here, the place in its lower bits."""


def check_places(places: Iterable[CodePlace], owners: int) -> None:
    """Raise ValueError or TypeError unless all are such places: a file may hold anything. `owners`: how many there are."""
    for core, routine, owner, place in places:
        if [type(each) for each in (core, routine, owner, place)] != [str, str, int, int]:
            raise TypeError("the place of a routine must be two names and two whole numbers")
        if owner not in range(owners) or place not in range(log.OFFSET_MASK + 1):
            raise ValueError("the place of a routine must be one in the memory of an owner")


def moves_of(core: str, recorded: Iterable[CodePlace], here: Iterable[CodePlace]) -> Table:
    """Return where each routine of a core was, and how far it has moved, rows in the order of where they were.

    Raises LookupError for one that is not outside of L1 here.
    """
    now = {routine: (owner, place) for of, routine, owner, place in here if of == core}
    before = [(routine, owner, place) for of, routine, owner, place in recorded if of == core]
    places = [(owner << OWNER_BIT | place, now[routine]) for routine, owner, place in before]
    moves = [(was, (owner << OWNER_BIT | place) - was) for was, (owner, place) in sorted(places)]
    return np.array(moves, np.int64).reshape(-1, 2)


def moved(accesses: Accesses, moves: Table) -> Accesses:
    """Return accesses that fetch code from where it lies now. Raises ValueError for a fetch from where none was."""
    if not moves[:, 1].any():
        return accesses
    fetches = np.flatnonzero(accesses[:, KIND] == log.FETCH)
    was = accesses[fetches, OWNER].astype(np.int64) << OWNER_BIT | accesses[fetches, BYTE]
    routine = np.searchsorted(moves[:, 0], was, "right") - 1
    if (routine < 0).any():
        raise ValueError("code is fetched from where none lies")
    now = was + moves[routine, 1]
    if (now >> OWNER_BIT != moves[routine].sum(axis=1) >> OWNER_BIT).any():  # behind the end of its memory
        raise ValueError("code is fetched from where none lies")
    there = accesses.copy(order="K")
    there[fetches, OWNER], there[fetches, BYTE] = now >> OWNER_BIT, now & log.OFFSET_MASK
    return there
