"""A minute of `benchmarks/fuzz.py`, at most: inputs of every kind, wrong by chance."""

from __future__ import annotations

import pytest

from benchmarks.fuzz import fuzz
from benchmarks.fuzzing.inputs import KINDS

MOST = 1000
MOST_S = 60


@pytest.mark.exhaustive
def test_every_input_is_taken_or_refused_in_a_few_words() -> None:
    """No traceback, no long message, no second spent without an end."""
    tally = fuzz(12, seconds=MOST_S, most=MOST)
    assert not tally.faults, "\n".join(tally.lines())
    # one of each at least, however busy the machine is
    assert {kind for kind, _ in tally.counts} == {each.__name__ for each in KINDS}
