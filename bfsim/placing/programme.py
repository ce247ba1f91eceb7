"""The integer programme: choose a stretch of memory for each item, so that the slower core's frame is shortest.

    minimise   T + TOTAL_WEIGHT · (stalls of all cores) + a cycle a step down each item's order of choices
    such that  each item has one place,
               the items in a stretch take no more bytes than it has,
               T ≥ a core's cycles a frame + the stalls of what it accesses,   for each core.

It knows only items, stretches and cycles; HiGHS solves it.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import coo_array

from bfsim.errors import LinkError

TOTAL_WEIGHT = 0.01
"""The weight of a cycle of any core, where one of the slower core weighs 1: cores wait for each other, too."""
STEP_CCLK = 1.0
"""The cycles a frame that each step down an item's order of choices must save; so ties have a fixed outcome."""
GAP = 1e-4
"""The solver stops when no solution can be better by more than this share of the stalls."""
NODES = 200
"""It also stops after this many nodes of its search, a limit that is the same on every machine."""
STDOUT = 1
"""File descriptor of standard output."""
INFEASIBLE = 2
"""Status of `milp` if there is no solution."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """An item in stretch number `stretch`, where it takes `nbytes` and stalls each core by some cycles a frame."""

    stretch: int
    nbytes: int
    cclk: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Item:
    """Something that needs a place. Of two choices with the same cost, the first is taken."""

    name: str
    nbytes: int
    choices: tuple[Choice, ...]


class NoRoomError(LinkError):
    """Raised when the items do not fit. `left` have no place if as many bytes as possible get one."""

    def __init__(self, left: Sequence[Item], why: str) -> None:
        super().__init__(why)
        self.left = tuple(left)


def solve(
    items: Sequence[Item], stretches: Sequence[int], busy_cclk: Mapping[str, float]
) -> tuple[Choice, ...]:
    """Return the best choice of each item. `stretches`: their bytes; `busy_cclk`: each core's frame without stalls.

    Raises NoRoomError with the items that lack room, and how many bytes.
    """
    for each in items:
        if not any(choice.nbytes <= stretches[choice.stretch] for choice in each.choices):
            raise NoRoomError([each], _too_large(each, stretches))
    if not items:
        return ()
    rows = _Rows(items, stretches)
    cores = sorted(busy_cclk)
    stalls = {core: np.array([each.cclk.get(core, 0.0) for each in rows.choices]) for core in cores}
    total = np.sum([stalls[core] for core in cores], axis=0)
    slowest = max(busy_cclk.values())
    constraints = [
        *rows.fits(stretches, exactly=True),
        *(_below_frame(stalls[core], slowest - busy_cclk[core]) for core in cores),
    ]
    cost = np.append(TOTAL_WEIGHT * total + STEP_CCLK * rows.steps, 1.0)
    found = _milp(cost, constraints)
    if found is None:
        raise _no_room(rows, stretches)
    return tuple(rows.choices[each] for each in rows.chosen(found))


class _Rows:
    """A variable for each possible choice of each item, and last the frame's excess over the busiest core's cycles."""

    def __init__(self, items: Sequence[Item], stretches: Sequence[int]) -> None:
        found = [
            (owner, step, choice)
            for owner, each in enumerate(items)
            for step, choice in enumerate(each.choices)
            if choice.nbytes <= stretches[choice.stretch]
        ]
        self.items = items
        self.choices = [choice for _, _, choice in found]
        self.owners = np.array([owner for owner, _, _ in found])
        self.steps = np.array([step for _, step, _ in found])

    def fits(self, stretches: Sequence[int], *, exactly: bool) -> list[LinearConstraint]:
        """Return the constraints that each item has one place, or at most one, and that no stretch is overfull."""
        count = len(self.choices)
        places = coo_array(
            (np.ones(count), (self.owners, np.arange(count))), shape=(len(self.items), count + 1)
        )
        shares = [each.nbytes / max(1, stretches[each.stretch]) for each in self.choices]
        used = coo_array(
            (shares, ([each.stretch for each in self.choices], range(count))),
            shape=(len(stretches), count + 1),
        )
        return [
            LinearConstraint(places.tocsr(), float(exactly), 1.0),
            LinearConstraint(used.tocsr(), -np.inf, 1.0),
        ]

    def chosen(self, found: NDArray[np.float64]) -> list[int]:
        """Return the variables that are 1."""
        return [int(each) for each in np.flatnonzero(found[:-1] > 0.5)]


def _below_frame(stalls: NDArray[np.float64], slack_cclk: float) -> LinearConstraint:
    """Return the constraint that no core's frame is longer; its work is `slack_cclk` less than that of the busiest."""
    return LinearConstraint(np.append(stalls, -1.0)[np.newaxis], -np.inf, slack_cclk)


def _milp(cost: NDArray[np.float64], constraints: Sequence[LinearConstraint]) -> NDArray[np.float64] | None:
    """Return the variables of least cost: places are 0 or 1, the frame is continuous. None if there is no solution."""
    whole = np.append(np.ones(len(cost) - 1), 0)
    with _silent():
        result = milp(
            cost,
            constraints=constraints,
            integrality=whole,
            bounds=Bounds(0, np.append(np.ones(len(cost) - 1), np.inf)),
            options={"mip_rel_gap": GAP, "node_limit": NODES},
        )
    if result.status == INFEASIBLE:
        return None
    found: NDArray[np.float64] | None = result.x
    assert found is not None, result.message
    return found


@contextmanager
def _silent() -> Iterator[None]:
    """Keep compiled code from standard output: HiGHS 1.12 prints debugging lines there (its issue 2783)."""
    buffers = ctypes.CDLL(None)
    sys.stdout.flush()
    buffers.fflush(None)
    with ExitStack() as stack:
        try:
            kept = os.dup(STDOUT)
        except OSError:  # there is no standard output
            yield
            return
        stack.callback(os.close, kept)
        stack.callback(os.dup2, kept, STDOUT)
        stack.callback(buffers.fflush, None)
        with Path(os.devnull).open("wb") as nowhere:
            os.dup2(nowhere.fileno(), STDOUT)
        yield


def _too_large(item: Item, stretches: Sequence[int]) -> str:
    most = max((stretches[each.stretch] for each in item.choices), default=0)
    return (
        f"{item.name} must fit in one memory, not take {item.nbytes:,} bytes: the largest stretch that is free for it has "
        f"{most:,}, so {item.nbytes - most:,} bytes are lacking"
    )


def _no_room(rows: _Rows, stretches: Sequence[int]) -> NoRoomError:
    """Return the error with the items that have no place when as many bytes as possible have one."""
    cost = np.append(-np.array([each.nbytes for each in rows.choices], float), 0.0)
    found = _milp(cost, rows.fits(stretches, exactly=False))
    assert found is not None, "nothing has to have a place"
    placed = {int(rows.owners[each]) for each in rows.chosen(found)}
    left = [each for number, each in enumerate(rows.items) if number not in placed]
    names = ", ".join(f"{each.name} ({each.nbytes:,} bytes)" for each in left)
    lacking = sum(each.nbytes for each in left)
    return NoRoomError(
        left,
        f"the firmware must fit in the memories that the LDF has, but {lacking:,} bytes are lacking: {names} "
        f"{'has' if len(left) == 1 else 'have'} no place, wherever the rest lies",
    )
