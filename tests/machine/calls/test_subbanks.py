"""What a DMA moves to and from the sub-banks of L1: counted run by run, as if element by element."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from bfsim.machine.bus import state as w
from bfsim.machine.bus.traffic import count_subbanks

L1_FIRST, SUBBANK_BITS = 1 << 20, 12
SIDE = w.TRANSFERS_AT + w.FROM


@given(
    first=st.integers(20_000, 24_000),
    step=st.sampled_from([-640, -4, -1, 0, 1, 2, 4, 12, 640, 5000]),
    count=st.integers(1, 30),
)
def test_a_run_across_subbanks_is_counted_as_its_elements(first: int, step: int, count: int) -> None:
    """Upwards, downwards, in steps beyond a sub-bank, and on the spot."""
    state = np.zeros(w.TRANSFERS_AT + w.TRANSFER_WORDS, np.int64)
    state[w.L1_FIRST], state[w.SUBBANK_BITS] = L1_FIRST, SUBBANK_BITS
    state[SIDE + w.POSITION], state[SIDE + w.X_MODIFY] = L1_FIRST + max(first, first - count * step), step
    elements = max(first, first - count * step) + step * np.arange(count)
    count_subbanks(state.data, SIDE, count)
    counted = state[w.SUBBANKS_AT : w.SUBBANKS_AT + w.MAX_SUBBANKS]
    assert counted.tolist() == np.bincount(elements >> SUBBANK_BITS, minlength=w.MAX_SUBBANKS).tolist()
