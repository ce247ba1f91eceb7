"""Which pictures of two cameras belong together."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import RecordingError
from bfsim.recording.importing.pairs import pairs_of, side_of


def paths(folder: str, *names: object) -> list[Path]:
    """Pictures of a folder."""
    return [Path(folder) / f"{name}.png" for name in names]


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("left_07", "right_07"),
        ("7", "7"),
        ("L7", "r7"),
        ("im7_left", "im7_right"),
        ("cam-l-7", "cam-r-7"),
        ("imageL7", "imageR7"),
    ],
)
def test_names_tell_pairs(left: str, right: str) -> None:
    """Without what says the camera; also beside pictures that have none, which are listed with their folder."""
    lefts, rights = paths("a", left, "left_1"), paths("b", "right_9", right)
    pairs, alone = pairs_of(lefts, rights, "pictures")
    assert pairs == [(lefts[0], rights[1])]
    assert [each.name for each in alone] == ["a/left_1.png", "b/right_9.png"]


def test_a_letter_within_a_word_is_no_camera() -> None:
    """`roller` and `oe` are not the same, and neither are numbers."""
    with pytest.raises(RecordingError, match="pictures must have names that tell the pairs.*not 1 and 2"):
        pairs_of(paths("a", "roller"), paths("b", "oe", "oe2"), "pictures")


@pytest.mark.parametrize(
    ("name", "side"),
    [
        ("left_07", "left"), ("imgRight7", "right"), ("STEREO_LEFT", "left"), ("bowling_r", "right"), ("imageL7", "left"),
        ("roller", None), ("07", None), ("left_of_the_right", None), ("IMAGEL7", None),
    ],
)  # fmt: skip
def test_a_name_says_left_or_right_or_neither(name: str, side: str | None) -> None:
    """Letters of other words say nothing, and neither do both sides."""
    assert side_of(name) == side


def test_names_with_nothing_in_common_go_by_order() -> None:
    """Time stamps of two cameras: if there are as many. Otherwise it would be a guess, and is refused."""
    lefts, rights = paths("a", 1001, 1034), paths("b", 1002, 1035)
    assert pairs_of(lefts, rights, "pictures") == (list(zip(lefts, rights, strict=True)), [])
    with pytest.raises(RecordingError, match="or be as many of either camera, .* not 2 and 1"):
        pairs_of(lefts, rights[:1], "pictures")


def test_names_that_come_twice_are_told() -> None:
    """1.png and 1.jpg in one folder: by their order, 1.jpg would go with 2.png."""
    twice, once = [Path("a/1.png"), Path("a/1.jpg")], paths("b", 1, 2)
    with pytest.raises(
        RecordingError, match=r"pictures must .*, but a/1\.png and a/1\.jpg both go with b/1\.png"
    ):
        pairs_of(twice, once, "pictures")
    with pytest.raises(RecordingError, match=r"a/1\.png and a/1\.jpg both go with b/1\.png"):
        pairs_of(once, twice, "pictures")


def test_names_that_come_twice_without_a_partner_are_alone() -> None:
    """They hinder no pair."""
    pairs, alone = pairs_of([Path("a/1.png"), Path("a/1.jpg"), Path("a/2.png")], paths("b", 2), "pictures")
    assert pairs == [(Path("a/2.png"), Path("b/2.png"))]
    assert [each.name for each in alone] == ["a/1.png", "a/1.jpg"]


@given(st.sets(st.integers(0, 50)), st.sets(st.integers(0, 50)))
def test_every_picture_is_in_a_pair_or_listed(left: set[int], right: set[int]) -> None:
    """Whatever is missing on either side."""
    if not left & right:
        return
    pairs, alone = pairs_of(paths("a", *sorted(left)), paths("b", *sorted(right)), "pictures")
    assert {int(each.stem) for each, _ in pairs} == {int(each.stem) for _, each in pairs} == left & right
    assert len(alone) == len(left ^ right)
