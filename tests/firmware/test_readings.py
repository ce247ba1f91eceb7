"""Other readings of the thesis (`benchmarks.robot`): each runs, and all but two see what the firmware `thesis` sees."""

from __future__ import annotations

from functools import cache

import pytest

from benchmarks.robot.readings import OF_THE_THESIS, Reading
from bfsim.run import simulate

SEES_OTHERS = {
    "blobs: all colours at once": "circles",
    "lines: by the labels of the row above": "lines",
}
"""Of readings that do not leave what `thesis` leaves, what they see otherwise in the first picture."""


def seen_by(reading: Reading) -> dict[str, int]:
    """Return the numbers that a reading publishes of the first picture of the built-in recording."""
    (frame,) = simulate(frames=1, firmware=reading.firmware, profile="vdsp-O2").frames
    return dict(frame.results)


@cache
def seen_by_thesis() -> dict[str, int]:
    """Return those of the firmware `thesis`."""
    return seen_by(OF_THE_THESIS[0])


@pytest.mark.exhaustive
@pytest.mark.parametrize("reading", OF_THE_THESIS, ids=lambda each: each.title)
def test_a_reading_sees_what_the_thesis_sees(reading: Reading) -> None:
    expected, seen = seen_by_thesis(), seen_by(reading)
    assert seen.keys() == expected.keys()
    others = {name.rpartition("_")[0] for name in seen if seen[name] != expected[name]}
    assert others == ({SEES_OTHERS[reading.title]} if reading.title in SEES_OTHERS else set())
