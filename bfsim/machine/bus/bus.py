"""What moves between the memories: transfers of the DMAs and accesses of the cores, played by the compiled weave.

The bus keeps its own time, which is behind the simulated time until somebody looks. Whoever wants to know whether something is
done settles it first; while anybody waits, the simulation plays it up to each event, and wakes those whose transfer is over.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from fractions import Fraction
from math import lcm
from typing import Any

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.chip.dma_registers import ELEMENT_BYTES
from bfsim.chip.spec import BoardSpec
from bfsim.errors import FirmwareError
from bfsim.kernel import access_trace as log
from bfsim.machine.bus import state as w
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.bus.sdram import new_sdram
from bfsim.machine.bus.stretches import end_of_stretch
from bfsim.machine.bus.told import ToldBus
from bfsim.machine.bus.traffic import traffic_records
from bfsim.machine.bus.transfer_plans import Pace, Played, Transfer, TransferPlan, Walk
from bfsim.machine.bus.weave import Weave, compiled_weave
from bfsim.machine.memories import Memories
from bfsim.machine.simulation import Simulation
from bfsim.machine.timeline import Timeline
from bfsim.trace import TrafficRecord

TRANSFER_LAYOUT = struct.Struct(f"@{w.TRANSFER_WORDS}q")

# Ranks of DMA: HRM of the BF537, 5-50 to 5-54 (lower channel first, memory DMA last); DMA1 before DMA2 [assumed].
RANKS = {
    w.PPI0: 0, w.PPI1: 1, w.MDMA1_0: 20, w.MDMA1_1: 21, w.SPI: 40, w.MDMA2_0: 44, w.MDMA2_1: 45, w.IMDMA_0: 48, w.IMDMA_1: 49,
}  # fmt: skip
INTERNAL = (w.IMDMA_0, w.IMDMA_1)
"""The streams of the internal DMA."""
PARTNERS = ((w.MDMA1_0, w.MDMA1_1), (w.MDMA2_0, w.MDMA2_1))
CORE_FIRST, CORE_LAST = -100, 200  # ranks of core A; core B has its own turn after A had the bus
STORES_AFTER = 10  # loads overtake stores (Programming Reference p.294)
ONE_TICK = Fraction(1)


class Bus:
    """The SDRAM bus and the port of L2 of one board, with all who use them."""

    def __init__(
        self, env: Simulation, board: BoardSpec, memories: Memories, weave: Weave = compiled_weave
    ) -> None:
        self._env = env
        self._board = board
        self._chip = board.chip
        self._clocks = board.clocks
        self._registers = memories.registers
        self._state: Any = np.zeros(w.STATE_WORDS, np.int64)
        self._memory: Any = memories.arena.view(np.uint32)
        self.words: Any = self._state.data
        """The whole state, word by word."""
        self.owners = MemoryOwners(self.words, memories.sdram_end, memories.l2_end)
        self._advance = weave(self._state, self._memory)
        self._plans = 0
        self._waiting: dict[int, simpy.Event] = {}
        self._told: ToldBus | None = None
        self._state[: w.SDRAM_WORDS] = new_sdram(board)
        self._set_up(board, memories)
        self._set_masters(board)
        free = np.arange(w.MAX_TRANSFERS)[::-1]
        self._state[w.FREE_PLACES_AT : w.FREE_PLACES_AT + w.MAX_TRANSFERS] = free
        env.follow(self)

    def _set_up(self, board: BoardSpec, memories: Memories) -> None:
        chip, clocks = board.chip, board.clocks
        l2 = chip.l2
        bus = {
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
        for core in range(w.CORES):
            play = w.PLAYS_AT + core * w.PLAY_WORDS
            bus |= {play + w.ACTS_AT: w.NEVER, play + w.AWAITED: w.NONE}
        for word, value in bus.items():
            self._state[word] = value

    def _set_masters(self, board: BoardSpec) -> None:
        chip = board.chip
        gap = chip.dma.read_word_sclk - 1
        cores = CORE_LAST if board.dma_over_core else CORE_FIRST
        ranks = RANKS | {w.CORE_A + core: cores + core for core in range(w.CORES)}
        ranks |= {w.STORES_A + core: cores + STORES_AFTER + core for core in range(w.CORES)}
        partners = dict(PARTNERS) | {other: one for one, other in PARTNERS}
        for number, rank in ranks.items():
            fields = {
                w.RANK: rank, w.READY: w.NEVER, w.TRANSFER: w.NONE, w.LAST_TRANSFER: w.NONE, w.PARTNER: partners.get(number, w.NONE),
                w.FIFO: chip.dma.fifo_words + (chip.ppi_fifo_words if number in (w.PPI0, w.PPI1) else 0),
                w.GAP_NUMERATOR: gap.numerator, w.GAP_DENOMINATOR: gap.denominator * chip.dma.fifo_words,
            }  # fmt: skip
            for word, value in fields.items():
                self._state[w.MASTERS_AT + number + word] = value

    # ---- time

    def settle(self) -> None:
        """Grant everything that was asked for before the simulated time."""
        self.play_until(self._env.tick)
        if self._told:
            self._told.sample(self._env.tick)

    def play_until(self, tick: int) -> bool:
        """Grant everything that was asked for before `tick`; stop early, with True, at an end that somebody waits for.

        The event of whoever waits is put on the simulation's queue at its tick.
        """
        while (woken := self._advance(tick)) != w.NONE:
            event = self._waiting.pop(woken, None)
            if event is not None:
                self._env.trigger_at(event, self.words[w.DONE_AT])
                return True
        return False

    @property
    def is_awaited(self) -> bool:
        """Whether anybody waits for an end."""
        return bool(self._waiting)

    # ---- transfers

    def plan_copy(
        self, master: int, source: Walk, destination: Walk, count: int, *, element_bytes: int, setup: int, name: str = ""
    ) -> TransferPlan:  # fmt: skip
        """Plan to move `count` elements by a memory DMA that takes `setup` ticks to start. `name`: what is moved, for people."""
        mode = self._mode_of_copy(master, source.offset, destination.offset)
        word = self._on_chip_ticks(master) if mode in (w.ON_CHIP, w.THROUGH_L2_PORT) else ONE_TICK
        return self._plan(
            master, mode, source, destination, count, element_bytes, setup, Pace(0, 1, word, ONE_TICK), name
        )

    def plan_fetch(self, master: int, offset: int, elements: int, setup: int) -> TransferPlan:
        """Plan to fetch a descriptor of 16-bit `elements` into the registers of a channel, which takes `setup` ticks besides."""
        memory, registers = (
            Walk(first, elements, ELEMENT_BYTES, ELEMENT_BYTES) for first in (offset, self._registers)
        )
        return self.plan_copy(
            master, memory, registers, elements, element_bytes=ELEMENT_BYTES, setup=setup, name="descriptor"
        )

    def _mode_of_copy(self, master: int, source: int, destination: int) -> int:
        sdram_end, l2_end = self.words[w.SDRAM_END], self.words[w.L2_END]
        if source < sdram_end:
            return w.BOTH if destination < sdram_end else w.READ
        if destination < sdram_end:
            return w.WRITE
        is_in_l2 = source < l2_end or destination < l2_end
        return w.THROUGH_L2_PORT if master in INTERNAL and is_in_l2 else w.ON_CHIP

    def _on_chip_ticks(self, master: int) -> Fraction:
        dma = self._chip.dma
        if master in INTERNAL:
            return Fraction(dma.imdma_word_cclk * self._clocks.cclk_ticks)
        return dma.on_chip_word_sclk * self._clocks.sclk_ticks

    def plan_receive(
        self, master: int, source: Walk, destination: Walk, count: int, *, element_bytes: int, pace: Pace
    ) -> TransferPlan:
        """Plan to write `count` elements as a device delivers them."""
        return self._plan(master, w.PACED_IN, source, destination, count, element_bytes, 0, pace)

    def plan_send(
        self, master: int, source: Walk, destination: Walk, count: int, *, element_bytes: int, pace: Pace
    ) -> TransferPlan:
        """Plan to read `count` elements as a device takes them."""
        return self._plan(master, w.PACED_OUT, source, destination, count, element_bytes, 0, pace)

    def _plan(
        self, master: int, mode: int, source: Walk, destination: Walk, count: int, element_bytes: int, setup: int, pace: Pace,
        name: str = "",
    ) -> TransferPlan:  # fmt: skip
        for side in (source, destination):
            if count % side.x_count:
                raise FirmwareError(
                    f"a DMA transfer must have whole lines of {side.x_count} elements, not {count} in all"
                )
        parts = lcm(pace.element_ticks.denominator, pace.line_ticks.denominator)
        element, line = (
            ticks.numerator * (parts // ticks.denominator) for ticks in (pace.element_ticks, pace.line_ticks)
        )
        return TransferPlan(
            master,
            (
                setup, 0, mode, element_bytes.bit_length() - 1, count, 0, 0,
                source.offset, source.x_count, source.x_modify, source.y_modify, source.x_count,
                destination.offset, destination.x_count, destination.x_modify, destination.y_modify, destination.x_count,
                pace.start, parts, element, line, pace.line_elements, 0, 0,
                master, self.owners.of(source.offset), self.owners.of(destination.offset),
            ),
            count * element_bytes,
            name=name,
        )  # fmt: skip

    def post(self, plan: TransferPlan, at: int = 0) -> Transfer:
        """Put a transfer behind those that its master has already; it begins at tick `at` or later."""
        words, now = self.words, self._env.tick
        top = words[w.FREE_TRANSFERS] - 1
        if top < 0:
            self.settle()  # those that are over make room
            top = words[w.FREE_TRANSFERS] - 1
        if top < 0:
            raise FirmwareError(f"DMA must have at most {w.MAX_TRANSFERS} transfers to do at a time")
        words[w.FREE_TRANSFERS] = top
        place = words[w.FREE_PLACES_AT + top]
        number = words[w.ALL_POSTED]
        words[w.ALL_POSTED] = number + 1
        words[w.ENDS_AT + number % w.ENDS] = w.NONE
        # the bus may still be behind the simulated time; the transfer is not
        TRANSFER_LAYOUT.pack_into(
            words, 8 * (w.TRANSFERS_AT + place * w.TRANSFER_WORDS), number, w.NONE, max(at, now), *plan.words
        )
        posted = words[w.POSTED]
        words[w.POSTS_AT + 2 * posted], words[w.POSTS_AT + 2 * posted + 1] = plan.master, place
        words[w.POSTED] = posted + 1
        if self._told:
            self._told.post(plan.master, number, plan.name, max(at, now), plan.nbytes, now)
        return Transfer(self, number, place)

    def when_done(self, transfer: Transfer) -> simpy.Event:
        """Return the event at a transfer's end, which must not be known yet."""
        self.words[w.TRANSFERS_AT + transfer.place * w.TRANSFER_WORDS + w.WAKE] = w.AT_END
        return self._await(transfer.number)

    def when_row(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of the next row that a transfer writes, or at its own end; neither is known yet."""
        self.words[w.TRANSFERS_AT + transfer.place * w.TRANSFER_WORDS + w.WAKE] = w.AT_ROWS
        return self._await(transfer.number)

    def moved_by(self, transfer: Transfer) -> int:
        """Return how many elements a transfer that is not over has moved."""
        return int(self.words[w.TRANSFERS_AT + transfer.place * w.TRANSFER_WORDS + w.MOVED])

    def _await(self, number: int) -> simpy.Event:
        event = self._waiting.get(number)
        if event is None:
            event = self._waiting[number] = self._env.event()
        return event

    def lost_by(self, master: int) -> int:
        """Return how many elements a peripheral's DMA has lost, since they found its FIFO full or did not come in time."""
        return int(self.words[w.MASTERS_AT + master + w.ALL_LOST])

    # ---- the timeline

    def use(self, timeline: Timeline) -> None:
        """Tell `timeline` of transfers and of the load from now on."""
        self._told = ToldBus(timeline, self._board, self.words, self.owners)

    @property
    def timeline(self) -> Timeline | None:
        """What is told what happens when, if anybody wants to know."""
        return self._env.timeline

    def tell(self, until: int) -> None:
        """Tell the timeline of the transfers that were over before tick `until`."""
        if self._told:
            self._told.tell(until)

    def flow_of(self, transfer: Transfer | None) -> int:
        """Return the flow from a transfer, if any, to the wait that it has just ended; 0 if nobody is told."""
        return self._told.flow_of(transfer.number) if self._told and transfer else 0

    # ---- cores

    def access(self, core: int, begin: int, cclk: int, entries: int) -> simpy.Event:
        """Play the first `entries` accesses of a core's log, of a call of `cclk` cycles from tick `begin`; return its end."""
        self._start_job(core, begin, cclk, entries)
        return self._await(w.NONE - 1 - core)

    def _start_job(self, core: int, begin: int, cclk: int, entries: int, spin: int = 0) -> None:
        self.settle()
        job = w.JOBS_AT + core * w.JOB_WORDS
        for word, value in (
            (w.STATE, w.STARTING), (w.BEGIN, begin), (w.TOTAL, cclk), (w.END, entries), (w.SPIN, spin),
        ):  # fmt: skip
            self.words[job + word] = value

    def play(
        self, core: int, clock_cclk: int, operations: NDArray[np.int64], accesses: NDArray[np.int64]
    ) -> simpy.Event:
        """Let a core do `operations` by itself from now on, its clock being at a cycle; return the end.

        `operations`: rows of OPERATION_WORDS as in `bus.state`, at most MAX_OPERATIONS of them. `accesses`: the log that those
        of their calls refer to, a row of entries and one of sites.
        """
        play = w.PLAYS_AT + core * w.PLAY_WORDS
        copies = self.words[play + w.COPIES]
        self._state[play : play + w.PLAY_WORDS] = 0
        for word, value in (
            (w.OPERATIONS_END, len(operations)), (w.CLOCK, clock_cclk), (w.ACTS_AT, self._env.tick),
            (w.AWAITED, w.NONE), (w.COPIES, copies),
        ):  # fmt: skip
            self.words[play + word] = value
        first = w.OPERATIONS_AT + core * w.MAX_OPERATIONS * w.OPERATION_WORDS
        self._state[first : first + operations.size] = operations.reshape(-1)
        room, count = self.room_of(core)[log.LOG :], accesses.shape[1]
        room[:count], room[w.LOG_ENTRIES : w.LOG_ENTRIES + count] = accesses
        return self._await(end_of_stretch(core))

    def played(self, core: int) -> Played:
        """Return what the last stretch of a core took. Raises FirmwareError if DMA had no room for all of its copies."""
        play = w.PLAYS_AT + core * w.PLAY_WORDS
        words: list[int] = self.words[play : play + w.PLAY_WORDS].tolist()
        if words[w.OPERATION] < words[w.OPERATIONS_END]:
            raise FirmwareError(f"DMA must have at most {w.MAX_TRANSFERS} transfers to do at a time")
        accounts = [
            words[each : each + w.ACCOUNT_WORDS] for each in range(w.ACCOUNTS, w.PLAY_WORDS, w.ACCOUNT_WORDS)
        ]
        used = sorted((each[w.TOUCH], number) for number, each in enumerate(accounts) if each[w.TOUCH])
        return Played(
            clock_cclk=words[w.CLOCK],
            issue_cclk=words[w.ISSUED],
            interlocks_cclk=words[w.INTERLOCKED],
            bus_stalls_cclk=words[w.ON_BUS : w.ACCOUNTS],
            accounts={number: accounts[number] for _, number in used},
        )

    def keep_plans(self, words: NDArray[np.int64]) -> NDArray[np.int64]:
        """Keep plans where stretches find them, each a row of the `words` of a `TransferPlan`; return their numbers."""
        numbers = np.arange(self._plans, self._plans + len(words))
        self._plans += len(words)
        if self._plans > w.MAX_PLANS:
            raise FirmwareError(f"a recorded run must have at most {w.MAX_PLANS} different copies")
        plans = self._state[w.PLANS_AT : w.PLANS_AT + self._plans * w.PLAN_WORDS].reshape(-1, w.PLAN_WORDS)
        plans[numbers, w.SETUP :] = words
        return numbers

    def log_in_l2(self, core: int, stamp_cclk: int, kind: int) -> int:
        """Make the log of a core that of one access to a shared variable in L2; return the number of its entries."""
        entry = stamp_cclk << log.STAMP_BIT | kind << log.KIND_BIT | self.words[w.L2_FIRST]
        room = self.room_of(core)
        room[log.LOG], room[log.LOG + w.LOG_ENTRIES] = entry, w.NO_SITE
        return 1

    def spin(self, core: int, since: int) -> None:
        """Let a core that found a lock taken at tick `since` try TESTSET again and again, until `stop_spinning`."""
        turn = self._spin_ticks()
        self._start_job(core, since + turn, 0, self.log_in_l2(core, 0, log.TEST_AND_SET), turn)

    def _spin_ticks(self) -> int:
        """Return what lies between the end of a TESTSET and the moment at which the next one asks for its memory."""
        events = self._chip.events
        return (events.spin_cclk + events.testset_cclk) * self._clocks.cclk_ticks

    def pause_spinning(self, core: int) -> None:
        """Let a core that spins do something else."""
        self.settle()
        self.words[w.JOBS_AT + core * w.JOB_WORDS + w.STATE] = w.IDLE
        self.words[w.MASTERS_AT + w.CORE_A + core + w.READY] = w.NEVER

    def stop_spinning(self, core: int) -> simpy.Event:
        """Let the next TESTSET of a core that spins be the last one, from now on; return its end."""
        self.settle()
        self.words[w.JOBS_AT + core * w.JOB_WORDS + w.SPIN] = 0
        return self._await(w.NONE - 1 - core)

    def stalls_of(self, core: int) -> Sequence[int]:
        """Return what the accesses of the core's last call stalled, in cycles, in the order of `bus.state`."""
        first = w.JOBS_AT + core * w.JOB_WORDS + w.STALL
        stalls: list[int] = self.words[first : first + w.STALLS].tolist()
        return stalls

    def stalls_at_sites(self, core: int, count: int) -> NDArray[np.int64]:
        """Return what the first `count` sites of a core have stalled so far: by site and, in the order of `bus.state`, reason.

        The last column counts the lines that were filled.
        """
        first = w.SITES_AT + core * w.MAX_SITES * w.SITE_WORDS
        found: NDArray[np.int64] = self._state[first : first + count * w.SITE_WORDS]
        return found.reshape(count, w.SITE_WORDS)

    def traffic(self) -> tuple[TrafficRecord, ...]:
        """Return what every master has moved so far."""
        return traffic_records(self._state, self.owners, self._clocks.cclk_ticks)

    def room_of(self, core: int) -> NDArray[np.int64]:
        """Return where a core's access trace keeps its state and its log."""
        first = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS
        room: NDArray[np.int64] = self._state[first : first + w.ACCESS_TRACE_WORDS]
        return room
