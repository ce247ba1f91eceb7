"""The initial state of the buses: the board's numbers, and no requests."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus import state as w
from bfsim.machine.bus.masters import PARTNERS, ranks_of
from bfsim.machine.bus.sdram import new_sdram
from bfsim.machine.memories import Memories
from bfsim.machine.pages import zeros


def new_state(board: BoardSpec, memories: Memories) -> NDArray[np.int64]:
    """Return the state for a board, as `bus.state` lays it out."""
    state = zeros(w.STATE_WORDS)
    state[: w.SDRAM_WORDS] = new_sdram(board)
    for word, value in (_shared(board, memories) | _masters(board)).items():
        state[word] = value
    for core in range(w.CORES):
        play = w.PLAYS_AT + core * w.PLAY_WORDS
        state[play + w.ACTS_AT], state[play + w.AWAITED] = w.NEVER, w.NONE
    state[w.FREE_PLACES_AT : w.FREE_PLACES_AT + w.MAX_TRANSFERS] = np.arange(w.MAX_TRANSFERS)[::-1]
    return state


def _shared(board: BoardSpec, memories: Memories) -> dict[int, int]:
    """Return the values that all masters share, by word."""
    chip, clocks, l2 = board.chip, board.clocks, board.chip.l2
    return {
        w.CCLK: clocks.cclk_ticks,
        w.SDRAM_END: memories.sdram_end,
        w.L2_FIRST: memories.sdram_end,
        w.L2_END: memories.l2_end,
        w.L1_FIRST: memories.l1,
        w.SUBBANK_BITS: chip.l1.subbank_bytes.bit_length() - 1,
        w.L2_READ: l2.read_cclk * clocks.cclk_ticks if l2 else 0,
        w.L2_NEXT: l2.next_cclk * clocks.cclk_ticks if l2 else 0,
        w.L2_PORT_BITS: l2.port_bytes.bit_length() - 1 if l2 else 0,
        w.CORE_SYNC: chip.external.core_sync_sclk * clocks.sclk_ticks,
        w.STORE_DEPTH: chip.external.store_buffer,
        w.DEB_PERIOD: board.deb_period_transfers,
        w.MDMA_PERIOD: board.mdma_period_transfers,
        w.LINE_BYTES: chip.cache.line_bytes,
        w.BURST_WORDS: chip.dma.fifo_words,
        w.LAST_CORE: w.NONE,
        w.LAST_CORE_AT_L2: w.NONE,
        w.FREE_TRANSFERS: w.MAX_TRANSFERS,
    }


def _masters(board: BoardSpec) -> dict[int, int]:
    """Return the values of each master, by word."""
    chip = board.chip
    gap = chip.dma.read_word_sclk - 1
    words: dict[int, int] = {}
    for number, rank in ranks_of(dma_over_core=board.dma_over_core).items():
        fields = {
            w.RANK: rank,
            w.READY: w.NEVER,
            w.TRANSFER: w.NONE,
            w.LAST_TRANSFER: w.NONE,
            w.PARTNER: PARTNERS.get(number, w.NONE),
            w.FIFO: chip.dma.fifo_words + (chip.ppi_fifo_words if number in (w.PPI0, w.PPI1) else 0),
            w.GAP_NUMERATOR: gap.numerator,
            w.GAP_DENOMINATOR: gap.denominator * chip.dma.fifo_words,
        }
        words |= {w.MASTERS_AT + number + field: value for field, value in fields.items()}
    return words
