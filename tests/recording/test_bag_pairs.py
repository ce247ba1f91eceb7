"""`record import` of bags: which pictures are a pair, at which times, and which are left over."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import RecordingError
from bfsim.recording.importing.importer import import_recording
from bfsim.recording.importing.time_pairs import nearest_pairs, rising
from tests.recording.bag_imports import IMAGE, each_kind, greys, imported, run
from tests.recording.bags import (
    EPOCH_NS,
    LEFT,
    PERIOD_NS,
    RIGHT,
    Message,
    Ros,
    grey_pair,
    grey_rows,
)


@each_kind
def test_pairs_keep_their_pixels_and_times(kind: str, tmp_path: Path) -> None:
    """The first picture is at 0, and the right camera 3 ms behind."""
    path = Ros(kind).write(tmp_path, grey_pair(Ros(kind), range(5)))
    frames = imported(path)
    assert greys(frames) == [(10 + k, 100 + k) for k in range(5)]
    assert [(each.left_ns, each.right_ns) for each in frames] == [
        (k * PERIOD_NS, k * PERIOD_NS + 3_000_000) for k in range(5)
    ]
    assert all((each.left[:, ::2] == 128).all() for each in frames)


def test_a_single_file_of_ros_2_is_a_bag(tmp_path: Path) -> None:
    """Out of its folder, without metadata.yaml."""
    for kind in ("mcap", "db3"):
        folder = Ros(kind).write(tmp_path, grey_pair(Ros(kind), range(2)))
        (file,) = folder.glob(f"*.{kind}")
        assert len(imported(file)) == 2


@each_kind
def test_left_overs_are_listed(kind: str, tmp_path: Path) -> None:
    """A picture without a partner is in no pair, and the others stay together."""
    messages = grey_pair(Ros(kind), range(6))
    del messages[2 * 2], messages[2 * 4]  # the left one of frame 2, and the right one of frame 4
    path = Ros(kind).write(tmp_path, messages)
    assert greys(imported(path)) == [(10 + k, 100 + k) for k in (0, 1, 3, 5)]
    told = run("import", tmp_path / "told.mcap", path)
    assert told.exit_code == 0
    assert "4 stereo frames of 8x4 at" in told.output
    assert f"Skipped: {LEFT} 3: no picture of {RIGHT} within 20 ms" in told.output
    assert f"Skipped: {RIGHT} 2: no picture of {LEFT} within 20 ms" in told.output


def test_slop_is_the_limit_on_both_sides(tmp_path: Path) -> None:
    """3 ms apart: within 3 ms, and not within 2.9; without it, half a period."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, grey_pair(ros, range(3)))
    assert len(imported(path, slop_s=0.003)) == 3
    with pytest.raises(
        RecordingError, match=r"must be within 2.9 ms of each other, .* nearest two are 3 ms apart; `--slop`"
    ):
        imported(path, slop_s=0.0029)
    late = tmp_path / "late"
    late.mkdir()
    path = ros.write(late, grey_pair(ros, range(3), right_after_ns=PERIOD_NS // 2))
    assert greys(imported(path)) == [(10, 100), (11, 101), (12, 102)]
    one = tmp_path / "one"
    one.mkdir()
    assert len(imported(ros.write(one, grey_pair(ros, [0], right_after_ns=16_000_000)))) == 1


def test_pictures_written_camera_by_camera_are_paired(tmp_path: Path) -> None:
    """The order in the bag does not matter."""
    ros = Ros("ros1")
    messages = grey_pair(ros, range(4))
    path = ros.write(tmp_path, [*messages[1::2], *messages[::2]])
    assert greys(imported(path)) == [(10 + k, 100 + k) for k in range(4)]


def test_a_time_stamp_that_goes_back_is_skipped(tmp_path: Path) -> None:
    """Of equal ones the first is taken."""
    ros = Ros("ros1")
    messages = grey_pair(ros, [0, 1, 1, 2])
    messages = [(*each[:2], EPOCH_NS + number, each[3]) for number, each in enumerate(messages)]
    path = ros.write(tmp_path, messages)
    summary = import_recording([path], tmp_path / "out.mcap")
    assert summary.frame_count == 3
    assert [each.name for each in summary.skipped] == [f"{LEFT} 2", f"{RIGHT} 2"]
    assert {each.reason for each in summary.skipped} == {"its time stamp is not later than those before"}


def test_pictures_without_time_stamps_go_by_the_bags_clock(tmp_path: Path) -> None:
    """And it is said."""
    ros = Ros("mcap")
    messages: list[Message] = [
        (topic, IMAGE, EPOCH_NS + k * PERIOD_NS + late_ns, ros.image(0, "mono8", grey_rows(k), 8))
        for k in range(3)
        for topic, late_ns in ((LEFT, 0), (RIGHT, 2_000_000))
    ]
    path = ros.write(tmp_path, messages)
    assert [(each.left_ns, each.right_ns) for each in imported(path)] == [
        (k * PERIOD_NS, k * PERIOD_NS + 2_000_000) for k in range(3)
    ]
    assert (
        "The pictures have no time stamps: they are paired by the times"
        in run("import", tmp_path / "a.mcap", path).output
    )


@given(*[st.lists(st.integers(0, 60), unique=True, max_size=12).map(sorted)] * 2, st.integers(0, 20))
def test_pairs_are_each_others_nearest(left: list[int], right: list[int], slop: int) -> None:
    """As a search through all pairs has it; none is used twice, and all rise."""
    numbers = nearest_pairs(np.array(left, np.int64), np.array(right, np.int64), slop)
    found = [(int(a), int(b)) for a, b in zip(*numbers, strict=True)]

    def nearest(time: int, others: list[int], tie: int) -> int:
        return min(range(len(others)), key=lambda each: (abs(others[each] - time), tie * each))

    expected = [
        (a, b)
        for a in range(len(left))
        for b in range(len(right))
        if abs(left[a] - right[b]) <= slop
        and nearest(left[a], right, -1) == b
        and nearest(right[b], left, 1) == a
    ]
    assert found == expected
    assert all(x[0] < y[0] and x[1] < y[1] for x, y in pairwise(found))


@given(st.lists(st.integers(0, 9)))
def test_rising_keeps_what_is_later_than_all_before(times: list[int]) -> None:
    """As a loop has it."""
    expected, last = [], -1
    for number, time in enumerate(times):
        if time > last:
            expected.append(number)
            last = time
    assert rising(np.array(times, np.int64)).tolist() == expected
