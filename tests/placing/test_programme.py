"""The integer programme on cases that one can work out by hand, and against every placement there is."""

from __future__ import annotations

import ctypes
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import milp

from bfsim.errors import LinkError
from bfsim.placing import programme
from bfsim.placing.programme import STEP_CCLK, TOTAL_WEIGHT, Choice, Item, NoRoomError, solve

SLOW, FAST = 0, 1


def item(name: str, nbytes: int, saves: float, core: str = "A") -> Item:
    """Something that waits `saves` cycles in the slow memory and none in the fast one."""
    return Item(
        name=name,
        nbytes=nbytes,
        choices=(
            Choice(stretch=SLOW, nbytes=nbytes, cclk={core: saves}),
            Choice(stretch=FAST, nbytes=nbytes, cclk={core: 0.0}),
        ),
    )


def in_fast(items: list[Item], room: int, busy: dict[str, float] | None = None) -> str:
    """Names of what the fast memory gets."""
    chosen = solve(items, [1_000_000, room], busy or {"A": 0.0})
    return "".join(each.name for each, choice in zip(items, chosen, strict=True) if choice.stretch == FAST)


def test_what_waits_most_gets_the_one_place() -> None:
    """Both are as large: 900 cycles against 400."""
    assert in_fast([item("a", 64, 400), item("b", 64, 900)], room=64) == "b"


def test_two_small_ones_beat_the_one_that_saves_most_a_byte() -> None:
    """A knapsack of 10 bytes: 6 bytes save 70, 5 and 5 save 50 each. By saving a byte the first would come first: 70 < 100."""
    assert in_fast([item("a", 6, 70), item("b", 5, 50), item("c", 5, 50)], room=10) == "bc"


def test_the_slower_core_comes_first() -> None:
    """A is 500 cycles behind: its 300 shorten the frame, B's 400 do not."""
    items = [item("a", 64, 300, "A"), item("b", 64, 400, "B")]
    assert in_fast(items, room=64, busy={"A": 1500.0, "B": 1000.0}) == "a"
    assert in_fast(items, room=64, busy={"A": 1000.0, "B": 1500.0}) == "b"


def test_the_frame_is_that_of_the_slower_core() -> None:
    """A would wait 300 and B 400, from the same start: one place goes to B, and the frame is 300 longer than without waits."""
    items = [item("a", 64, 300, "A"), item("b", 64, 400, "B")]
    assert in_fast(items, room=64, busy={"A": 1000.0, "B": 1000.0}) == "b"


def test_equals_stay_where_they_come_first() -> None:
    """A move must save a cycle: with less than that, as with nothing, the first choice is taken."""
    assert not in_fast([item("a", 4, 0), item("b", 4, STEP_CCLK / 2)], room=64)
    assert in_fast([item("a", 4, 0), item("b", 4, 2 * STEP_CCLK)], room=64) == "b"


def test_nothing_needs_no_place() -> None:
    assert solve([], [10], {"A": 5.0}) == ()


def test_one_that_is_larger_than_every_memory_is_named() -> None:
    """With what is lacking against the largest."""
    with pytest.raises(
        NoRoomError,
        match="huge must fit in one memory, not take 2,000,000 bytes.*1,000,000 bytes are lacking",
    ):
        in_fast([item("small", 4, 1), item("huge", 2_000_000, 1)], room=64)


def test_what_has_no_place_is_named() -> None:
    """Three of 600,000 bytes do not fit in memories of 1,000,000 and 700,000; two of them do."""
    items = [item(name, 600_000, 10) for name in "abc"]
    with pytest.raises(NoRoomError, match="600,000 bytes are lacking: [abc].* has no place") as refused:
        in_fast(items, room=700_000)
    assert len(refused.value.left) == 1
    assert issubclass(NoRoomError, LinkError)


def test_the_solver_is_silent(capfd, monkeypatch) -> None:
    """What compiled code prints while it solves is not seen, as it would stand in the JSON; before and after it is."""
    libc = ctypes.CDLL(None)

    def talkative(*arguments, **options):
        libc.puts(b"tmpSolver.run();")
        return milp(*arguments, **options)

    monkeypatch.setattr(programme, "milp", talkative)
    libc.puts(b"before")
    assert in_fast([item("a", 64, 400)], room=64) == "a"
    libc.puts(b"after")
    libc.fflush(None)
    assert capfd.readouterr().out == "before\nafter\n"


CCLK = st.integers(0, 1000)
ITEMS = st.lists(st.tuples(st.integers(1, 6), CCLK, CCLK, st.sampled_from("AB")), min_size=1, max_size=6)


@settings(max_examples=40, deadline=None)
@given(sizes=ITEMS, rooms=st.tuples(st.integers(0, 12), st.integers(0, 12)), busy=st.tuples(CCLK, CCLK))
def test_no_placement_is_better(sizes, rooms, busy) -> None:
    """Every placement of up to six items in three memories is tried: none has a smaller value than the one found."""
    items = [
        Item(
            name=str(number),
            nbytes=nbytes,
            choices=tuple(
                Choice(stretch=stretch, nbytes=nbytes, cclk={core: float(cclk)})
                for stretch, cclk in enumerate((slow + fast, fast, 0))
            ),
        )
        for number, (nbytes, slow, fast, core) in enumerate(sizes)
    ]
    stretches = [1000, *rooms]
    cycles = dict(zip("AB", map(float, busy), strict=True))

    def value(places: tuple[int, ...]) -> float:
        """What the programme minimises."""
        chosen = [each.choices[place] for each, place in zip(items, places, strict=True)]
        frames = {core: cycles[core] + sum(each.cclk.get(core, 0) for each in chosen) for core in cycles}
        total = sum(frames.values()) - sum(cycles.values())
        return max(frames.values()) + TOTAL_WEIGHT * total + STEP_CCLK * sum(places)

    def fits(places: tuple[int, ...]) -> bool:
        return all(
            sum(each.nbytes for each, place in zip(items, places, strict=True) if place == number) <= room
            for number, room in enumerate(stretches)
        )

    found = tuple(each.stretch for each in solve(items, stretches, cycles))
    assert fits(found)
    best = min(value(places) for places in product(range(3), repeat=len(items)) if fits(places))
    assert value(found) == pytest.approx(best, rel=1e-4, abs=1e-3)
