"""What holds on the bus whoever does what: order, accounts, bounds; and that runs of words are only a short cut."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise
from random import Random

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bfsim.machine.bus import state as w
from tests.machine.bench import Bench
from tests.machine.bus.scenarios import Scene
from tests.tiers import tried


def look(stops: Iterable[int], note: Callable[[], None]) -> Iterator[int]:
    """The same stops; whenever the next one is asked for, the bus was settled at the last one."""
    for stop in stops:
        note()
        yield stop


chances = st.integers(0, 2**32 - 1)


@given(seed=chances, stops=st.lists(st.integers(0, 8000), max_size=40))
def test_it_does_not_matter_when_the_bus_is_played(seed: int, stops: list[int]) -> None:
    """In many steps or in one, every end, every stall, every byte and every counter is the same."""
    at_once = Scene(Random(seed)).play()
    assert Scene(Random(seed)).play(sorted(stops)) == at_once


@tried(15, 60)
def test_runs_of_words_are_a_short_cut_only(examples: int) -> None:
    """Stopped at every single cycle no run is longer than a word."""

    @settings(max_examples=examples)
    @given(seed=chances)
    @example(seed=1481)  # a copy on the chip, which needs no bus, between words of both cameras
    def holds(seed: int) -> None:
        scene = Scene(Random(seed))
        stops = range(1, 20_000, scene.bench.spec.clocks.cclk_ticks)
        assert scene.play(stops) == Scene(Random(seed)).play()

    holds()


@given(seed=chances)
def test_the_bus_is_busy_for_its_words_and_never_for_longer_than_it_is(seed: int) -> None:
    """All words and openings fit between the words' own time and the time that passed; refresh comes on top."""
    scene = Scene(Random(seed))
    scene.play()
    bench = scene.bench
    sdram, traffic = bench.spec.sdram, [bench.traffic(master) for master in range(w.MASTERS)]
    words = sum(each.page_hits + each.page_misses + each.page_conflicts for each in traffic)
    misses = sum(each.page_misses for each in traffic)
    conflicts = sum(each.page_conflicts for each in traffic)
    busy = sum(each.busy for each in traffic)
    bound = bench.sclk(words + misses * sdram.miss_sclk + conflicts * sdram.conflict_sclk)
    assert bound <= busy <= bench.bus.words[w.COMMAND_FREE]


@given(seed=chances)
def test_everything_comes_to_an_end(seed: int) -> None:
    """Nobody is forgotten, no place is lost, no store stays in a buffer, and no end is before its begin."""
    scene = Scene(Random(seed))
    scene.play()
    words = scene.bench.bus.words
    assert None not in [each.end for each in (*scene.transfers, *scene.calls)]
    assert words[w.FREE_TRANSFERS] == w.MAX_TRANSFERS
    assert sorted(words[w.FREE_PLACES_AT : w.FREE_PLACES_AT + w.MAX_TRANSFERS]) == list(
        range(w.MAX_TRANSFERS)
    )
    for master in range(w.MASTERS):
        assert words[w.MASTERS_AT + w.READY + master] == w.NEVER
        assert words[w.MASTERS_AT + w.TRANSFER + master] == w.NONE
    for core in range(w.CORES):
        job = w.JOBS_AT + core * w.JOB_WORDS
        assert (words[job + w.STATE], words[job + w.STORES]) == (w.IDLE, 0)


@pytest.mark.parametrize("seed", range(4))
def test_commands_follow_each_other_on_the_bus(seed: int) -> None:
    """Looked at after every tick, a new access had the bus when the one before had given its command, and a refresh was over."""
    scene = Scene(Random(seed))
    words, seen = scene.bench.bus.words, [(0, 0)]
    scene.play(
        look(
            range(1, 20_000),
            lambda: seen.append((words[w.BEGAN] + words[w.REFRESH_WAIT], words[w.COMMAND_FREE])),
        )
    )
    last = dict(seen).items()
    assert len(last) > 10
    assert all(free <= granted for (_, free), (granted, _) in pairwise(last))


def test_plain_python_does_the_same_and_no_grants_overlap() -> None:
    """Not compiled: the same ends, bytes and counters; and there every grant can be watched."""
    seeds = (1, 2, 3, 4)
    done = subprocess.run(
        [sys.executable, "-W", "error", "-m", "tests.machine.bus.scenarios", *map(str, seeds)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert not done.stderr
    played = [json.loads(each) for each in done.stdout.splitlines()]
    assert [each["seed"] for each in played] == [*seeds]
    for plain in played:
        assert plain["left"] == Scene(Random(plain["seed"])).play()
        assert len(plain["grants"]) > 10
        assert all(end <= begin for (_, end), (begin, _) in pairwise(plain["grants"]))
        assert all(begin < end for begin, end in plain["grants"])


def test_a_bench_is_the_same_every_time() -> None:
    """Nothing depends on what was played before in this process."""
    first, again = (Scene(Random(7)).play() for _ in range(2))
    assert first == again
    assert Bench().bus.words[: w.ENDS_AT].tolist() == Bench().bus.words[: w.ENDS_AT].tolist()
