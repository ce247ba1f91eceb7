"""Stereo capture: which pictures are taken, which are missed, and what the cores get, at ticks worked out by hand.

The camera here needs 100 ns a line, 200 for a picture of two lines and 300 for a frame; a tick is 1 ns.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import cycle
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bfsim.chip.sensor_spec import SensorMode, SensorSpec
from bfsim.clocks import Clocks
from bfsim.errors import ConfigError
from bfsim.machine.buffers import FrameSize
from bfsim.machine.cameras.capture import LAST_START, Capture, Feed, Pair
from bfsim.machine.cameras.ppi import Ppi
from tests.machine.bench import Bench
from tests.machine.rig import STEADY, Picture

GHZ = 10**9
CLOCKS = Clocks(cclk_hz=Fraction(GHZ), sclk_hz=Fraction(GHZ))
MODE = SensorMode(
    width_px=4, height_px=2, ppi_clk_hz=Fraction(8 * GHZ, 100), line_clocks=8, frame_lines=3, lines_before=0
)
PICTURE_NBYTES = 16
Stamps = Sequence[tuple[int, int]]


@dataclass
class Seen:
    """What one core got: (tick, frame) of each picture."""

    frames: list[tuple[int, int]] = field(default_factory=list)

    @property
    def indexes(self) -> list[int]:
        """Frames of the recording, in the order in which they came."""
        return [index for _, index in self.frames]


def both(stamps: Iterable[int]) -> Stamps:
    """The same time stamps for the left and the right camera."""
    return [(each, each) for each in stamps]


def picture(index: int, left_ns: int, right_ns: int) -> Picture:
    """A picture that is full of its own number; the right one is brighter."""
    left = np.full((2, 8), index % 100, np.uint8)
    return Picture(index, left, left + 100, left_ns, right_ns)


class Studio:
    """Two cameras, frame buffers in L1 and two cores that only take their time."""

    def __init__(self, stamps: Stamps, *, frame_buffers: int, feed: Feed) -> None:
        bench = Bench(clocks=CLOCKS, outside_nbytes=2 * 2 * PICTURE_NBYTES)
        spec = replace(bench.spec, sensor=SensorSpec(name="quick", modes=(MODE,)))
        self.env = bench.env
        ppis = {
            core: Ppi(
                spec,
                FrameSize(MODE.width_px, MODE.height_px),
                STEADY,
                bench.bus,
                bench.memories,
                number=number,
                outside=bench.memories.outside + number * 2 * PICTURE_NBYTES,
                interrupt=lambda source: None,
            )
            for number, core in enumerate("AB")
        }
        starts = {"A": 0xFF80_0000, "B": 0xFF40_0000}
        pairs = [
            Pair(
                {
                    core: [bench.row(at + 16 * number + 8 * line, 8) for line in range(2)]
                    for core, at in starts.items()
                }
            )
            for number in range(frame_buffers)
        ]
        frames = (picture(index, *each) for index, each in enumerate(stamps))
        self.capture = Capture(bench.env, CLOCKS, ppis, pairs, frames, feed)
        self.seen = {"A": Seen(), "B": Seen()}

    def core(self, name: str, work_ticks: Iterable[int]) -> Generator[Any, Any, None]:
        """Take every picture, work so long on it, and look whether it stays what it was meanwhile."""
        for ticks in work_ticks:
            pair = yield from self.capture.claim(name)
            if pair is None:
                return
            self.seen[name].frames.append((self.env.tick, pair.index))
            expected = pair.index % 100 + (100 if name == "B" else 0)
            for moment in (0, ticks):
                yield self.env.timeout(moment)
                assert all((row.array == expected).all() for row in pair.rows[name])

    def play(self, work_a: Iterable[int], work_b: Iterable[int] | None = None) -> None:
        """Let both cores work for so many ticks on each picture; once through the list, it begins again."""
        self.env.process(self.core("A", cycle(work_a)))
        self.env.process(self.core("B", cycle(work_a if work_b is None else work_b)))
        self.env.run()


def play(
    stamps: Stamps, work: Iterable[int], *, frame_buffers: int = 2, feed: Feed = Feed.RECORDED
) -> Studio:
    """Play a recording to its end with cores that work alike."""
    studio = Studio(stamps, frame_buffers=frame_buffers, feed=feed)
    studio.play(work)
    return studio


def test_on_demand_the_next_picture_comes_while_the_firmware_works() -> None:
    """Full at 200; the next one starts at 300, a frame after the first, and waits, full at 500, until 1200."""
    studio = play(both([0] * 3), [1000], feed=Feed.DEMAND)
    assert studio.seen["A"].frames == [(200, 0), (1200, 1), (2200, 2)]


def test_on_demand_a_fast_firmware_gets_every_frame_of_the_sensor() -> None:
    """One picture each 300 ticks, whatever the recording's time stamps say."""
    studio = play(both([0, 7, 10**9]), [10], feed=Feed.DEMAND)
    assert studio.seen["A"].frames == [(200, 0), (500, 1), (800, 2)]


def test_on_demand_a_single_buffer_is_filled_after_the_work() -> None:
    """No double buffering: given back at 1200, filled from then to 1400."""
    studio = play(both([0] * 2), [1000], frame_buffers=1, feed=Feed.DEMAND)
    assert studio.seen["A"].frames == [(200, 0), (1400, 1)]


def test_on_demand_the_slower_core_sets_the_pace() -> None:
    """B is a frame behind; A takes a picture ahead, then the frame buffers run out."""
    studio = Studio(both([0] * 4), frame_buffers=2, feed=Feed.DEMAND)
    studio.play([10], [1000])
    assert studio.seen["A"].frames == [(200, 0), (500, 1), (1400, 2), (2400, 3)]
    assert studio.seen["B"].frames == [(200, 0), (1200, 1), (2200, 2), (3200, 3)]


def test_slow_firmware_misses_the_frames_that_were_overwritten() -> None:
    """By hand: 0 is worked on till 840; 1 waits and is overwritten by 2 at 600; 3 waits and is overwritten by 4 at 1200."""
    studio = play(both(range(0, 1800, 300)), [640])
    assert studio.seen["A"].frames == studio.seen["B"].frames == [(200, 0), (840, 2), (1480, 4), (2120, 5)]
    assert studio.capture.missed == [1, 3]


def test_the_newest_picture_wins() -> None:
    """With three buffers 1 and 2 are both full when the core comes back at 840: it gets 2, and 1 is missed."""
    studio = play(both([0, 300, 600]), [640], frame_buffers=3)
    assert studio.seen["A"].frames == [(200, 0), (840, 2)]
    assert studio.capture.missed == [1]


def test_a_picture_later_than_any_run_is_refused() -> None:
    """Times that no longer fitted 64 bits ended in an OverflowError. The last tick that is allowed is taken."""
    last = play(both([0, LAST_START]), [1])
    assert last.seen["A"].frames == [(200, 0), (LAST_START + 200, 1)]
    with pytest.raises(
        ConfigError, match=r"frame 1 must begin at most 2,305,843,009 s after .* of 1e\+09 Hz"
    ):
        play(both([0, LAST_START + 1]), [1])
    play(both([0, LAST_START + 1]), [1], feed=Feed.DEMAND)


def test_a_third_buffer_saves_the_wait_for_one_that_is_being_filled() -> None:
    """At 700 picture 2 is half in: two buffers have nothing else, three still have 1."""
    two = play(both([0, 300, 600]), [500], frame_buffers=2)
    assert two.seen["A"].frames == [(200, 0), (800, 2)]
    assert two.capture.missed == [1]
    three = play(both([0, 300, 600]), [500], frame_buffers=3)
    assert three.seen["A"].frames == [(200, 0), (700, 1), (1200, 2)]
    assert three.capture.missed == []


def test_the_oldest_waiting_picture_makes_room() -> None:
    """At 900 pictures 1 and 2 wait: 3 takes the place of 1, and the core, back at 1000, still gets 2 at once."""
    studio = play(both([0, 300, 600, 900]), [800], frame_buffers=3)
    assert studio.seen["A"].frames == [(200, 0), (1000, 2), (1800, 3)]
    assert studio.capture.missed == [1]


def test_a_picture_without_a_free_buffer_is_missed() -> None:
    """One buffer, and the core works on it when picture 1 comes."""
    studio = play(both([0, 300, 1000]), [500], frame_buffers=1)
    assert studio.seen["A"].frames == [(200, 0), (1200, 2)]
    assert studio.capture.missed == [1]


def test_a_recording_faster_than_the_sensor_loses_what_comes_too_early() -> None:
    """A picture takes 200: what is stamped 150 after another cannot be received, however fast the firmware is."""
    studio = play(both([0, 150, 300, 450]), [0])
    assert studio.seen["A"].indexes == [0, 2]
    assert studio.capture.missed == [1, 3]


def test_jitter_of_the_time_stamps_loses_nothing() -> None:
    """Stamps of a camera at its full rate, 300 apart, rounded and late now and then: the vertical blanking takes it up."""
    studio = play(both([0, 301, 600, 990, 1200, 1499]), [0])
    assert studio.seen["A"].indexes == [0, 1, 2, 3, 4, 5]
    assert studio.capture.missed == []


def test_a_pair_is_ready_when_its_later_picture_is() -> None:
    """The right camera is 80 behind; both cores get the pair at 280, and both get the same."""
    studio = play([(1000, 1080), (1400, 1480)], [0])
    assert studio.seen["A"].frames == studio.seen["B"].frames == [(280, 0), (680, 1)]


def test_the_cameras_may_overlap_from_frame_to_frame() -> None:
    """The left camera begins frame 1 at 300, while the right one, 250 late, is at frame 0 till 450."""
    studio = play([(0, 250), (300, 550)], [0])
    assert studio.seen["A"].frames == [(450, 0), (750, 1)]
    assert studio.capture.missed == []


def test_time_begins_with_the_first_picture() -> None:
    """A recording stamped with the time of day starts at tick 0 all the same."""
    noon_ns = 1_200_000_000_000_000_000
    studio = play([(noon_ns + 5, noon_ns)], [0])
    assert studio.seen["A"].frames == [(205, 0)]


def test_after_the_last_picture_there_is_none_however_often_one_asks() -> None:
    """Asking again is no error: firmware may have a loop in a loop."""
    studio = Studio(both([0]), frame_buffers=2, feed=Feed.DEMAND)
    answers = []

    def ask() -> Generator[Any, Any, None]:
        for _ in range(3):
            answers.append((yield from studio.capture.claim("A")))

    studio.env.process(ask())
    studio.env.run()
    assert [each is None for each in answers] == [False, True, True]


rising = st.lists(st.integers(1, 900), min_size=1, max_size=25)
works = st.lists(st.integers(0, 1500), min_size=1, max_size=5)


@example(gaps=[1, 200], skews=[0], work_a=[0], work_b=[0], frame_buffers=2, feed=Feed.RECORDED)
@given(
    gaps=rising,
    skews=works,
    work_a=works,
    work_b=works,
    frame_buffers=st.integers(1, 4),
    feed=st.sampled_from(Feed),
)
def test_every_frame_is_delivered_to_both_cores_or_missed(
    gaps: list[int], skews: list[int], work_a: list[int], work_b: list[int], frame_buffers: int, feed: Feed
) -> None:
    """Never both, never neither, always in order, complete while it is worked on; on demand none is missed."""
    left = np.cumsum(gaps)
    right = np.maximum.accumulate(left + np.resize(skews, len(left))) + np.arange(len(left))
    studio = Studio(
        list(zip(left.tolist(), right.tolist(), strict=True)), frame_buffers=frame_buffers, feed=feed
    )
    studio.play(work_a, work_b)
    delivered = studio.seen["A"].indexes
    assert delivered == studio.seen["B"].indexes == sorted(set(delivered))
    assert sorted(delivered + studio.capture.missed) == list(range(len(gaps)))
    if feed is Feed.DEMAND:
        assert studio.capture.missed == []


@pytest.mark.parametrize("feed", Feed)
def test_a_single_frame_is_delivered(feed: Feed) -> None:
    """The shortest recording."""
    assert play(both([5]), [0], feed=feed).seen["B"].frames == [(200, 0)]
