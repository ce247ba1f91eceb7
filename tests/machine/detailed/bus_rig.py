"""A bus alone, in either mode: what tests post is all that happens."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction

import numpy as np
import pytest

from bfsim.chip.boards import BOARDS, board_named
from bfsim.kernel.calls import access_log as log
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.transfer_plans import Pace, Transfer, Walk
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.detailed.bus import DetailedBus
from bfsim.machine.memories import Memories
from bfsim.machine.simulation import END_OF_TIME, Simulation
from tests.machine.bench import write_log

IN_EVERY_RUN = ("cm-bf561", "bf561-ezkit", "cm-bf533")
"""A board of each kind: the others are the first one with other clocks."""


def on_boards(names: Iterable[str]) -> pytest.MarkDecorator:
    """Play a test on each of these."""
    marked = [
        pytest.param(each, marks=() if each in IN_EVERY_RUN else pytest.mark.exhaustive) for each in names
    ]
    return pytest.mark.parametrize("board", marked)


each_board = on_boards(BOARDS)
with_l2 = on_boards(name for name, each in BOARDS.items() if each.chip.l2)
MODES = (WovenBus, DetailedBus)
NBYTES = 1 << 13  # of noise at the beginning of each memory, and of the world outside
CODE_BYTES = 40  # of each routine that is fetched
WORD = 4

CoreAccess = tuple[int, int, int]
"""Cycle of the call, kind, and offset."""


class Bench:
    """One bus with its memories; what tests post is all that happens."""

    def __init__(self, mode: Callable[..., Bus] = DetailedBus, board: str = "cm-bf561") -> None:
        self.spec = board_named(board)
        self.env = Simulation()
        self.memories = Memories(self.spec, NBYTES)
        self.bus = mode(self.env, self.spec, self.memories)
        self.sclk, self.cclk = self.spec.clocks.sclk_ticks, self.spec.clocks.cclk_ticks
        self.l2, self.l1, self.outside = self.memories.sdram_end, self.memories.l1, self.memories.outside
        self.bank = self.spec.sdram.bank_bytes
        self.calls: list[tuple[int, list[int]]] = []
        for number, first in enumerate((0, self.bank, self.l1, self.outside)):
            noise = np.random.default_rng(number).integers(0, 256, NBYTES, np.uint8)
            self.memories.bytes_from(first, NBYTES)[:] = noise

    def copy(
        self, source: int, target: int, count: int, master: int = w.MDMA1_0, setup_sclk: int = 0
    ) -> Transfer:
        """Copy words by a memory DMA."""
        walks = [Walk(first, count, WORD, WORD) for first in (source, target)]
        setup = setup_sclk * self.sclk
        plan = self.bus.planner.copy(master, walks[0], walks[1], count, element_bytes=WORD, setup=setup)
        return self.bus.post(plan)

    def camera(self, target: int, lines: int, words: int, word_sclk: Fraction) -> Transfer:
        """Receive a picture by PPI0, with a pause of two words behind each line."""
        pace = Pace(0, words, word_sclk * self.sclk, (words + 2) * word_sclk * self.sclk)
        walks = [Walk(first, words, WORD, WORD) for first in (self.outside, target)]
        plan = self.bus.planner.receive(
            w.PPI0, walks[0], walks[1], lines * words, element_bytes=WORD, pace=pace
        )
        return self.bus.post(plan)

    def call(self, core: int, accesses: Iterable[CoreAccess], cclk: int = 0, fetches: int = 0) -> None:
        """Make the accesses of a call, and `fetches` of its code (`keep_code`); its end and its stalls come to `calls`."""
        entries = [stamp << log.STAMP_BIT | kind << log.KIND_BIT | offset for stamp, kind, offset in accesses]
        done = self.bus.cores.access(core, 0, cclk, write_log(self.bus.logs, core, entries, fetches))
        done.callbacks.append(
            lambda _event: self.calls.append((self.env.tick, list(self.bus.cores.stalls_of(core))))
        )

    def play(self) -> None:
        """Play everything to its end."""
        self.env.run()
        self.bus.play_until(END_OF_TIME)

    def ends(self, *transfers: Transfer) -> list[int | None]:
        """Play everything and return when each transfer was done."""
        self.play()
        return [each.end for each in transfers]

    def content(self) -> list[bytes]:
        """Return what lies where tests copy from and to, and behind it: to look through all of SDRAM takes half a second."""
        firsts = (0, self.bank, self.l2, self.l1, self.outside)
        return [self.memories.bytes_from(first, 2 * NBYTES).tobytes() for first in firsts]

    def traffic(self) -> list[int]:
        """Return every counter of who moved what."""
        return list(self.bus.words[w.TRAFFIC_AT : w.SUBBANKS_AT])

    def stalls(self) -> dict[int, int]:
        """Play everything and return the stalls of the only call."""
        self.play()
        ((_end, stalls),) = self.calls
        return {reason: cclk for reason, cclk in enumerate(stalls) if cclk}
