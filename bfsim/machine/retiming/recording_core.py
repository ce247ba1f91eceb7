"""A core that notes what its firmware has it do, as `FrameWork`, while it does it as every core does."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from typing import Any

import numpy as np
import simpy

from bfsim.kernel import Kernel, Work
from bfsim.kernel import access_trace as log
from bfsim.machine.buffers import FrameSize
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.stalls import COUNTER_OF
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.calls.call_cache import CallCache
from bfsim.machine.cameras.settling import CameraSettings
from bfsim.machine.core.accounts import Account
from bfsim.machine.core.core import SPI, Core
from bfsim.machine.core.frames import Frame
from bfsim.machine.core.interrupts import Handler
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.dma.memory_dma import MemoryDma
from bfsim.machine.memories import Row
from bfsim.machine.retiming.work import ACCESS_COLUMNS, CALL, COPY_COLUMNS, FrameWork, Place
from bfsim.trace import StallReason

LATEST = 1 << 14
"""Copies of a core that can be waited for: the latest so many, of which the bus remembers the ends."""

Wait = Generator[Any, Any, Any]


class NotedStream(MdmaStream):
    """A memory DMA stream of a core that has its copies noted."""

    def __init__(self, stream: MdmaStream, note: Callable[[Row, Row, Transfer], None]) -> None:
        self._stream = stream
        self._note = note

    def copy(self, source: Row, destination: Row, at: int) -> Transfer:
        """Copy as the stream does."""
        transfer = self._stream.copy(source, destination, at)
        self._note(source, destination, transfer)
        return transfer


class RecordingCore(Core):
    """A core whose work is handed to `on_work`, frame by frame; what cannot be played again is told `on_obstacle`, in words."""

    def __init__(
        self,
        *arguments: Any,
        bus: Bus,
        calls: CallCache,
        streams: tuple[MdmaStream, MdmaStream],
        on_work: Callable[[FrameWork], None],
        on_obstacle: Callable[[str], None],
        **named: Any,
    ) -> None:
        noted = tuple(
            NotedStream(each, lambda *copied, number=number: self._note_copy(number, *copied))
            for number, each in enumerate(streams)
        )
        super().__init__(*arguments, bus=bus, calls=calls, streams=noted, **named)  # type: ignore[arg-type]
        self._on_work = on_work
        self._on_obstacle = on_obstacle
        self._inside = 0  # of calls that are noted as a whole
        self._prepared: dict[int, int] = {}
        self._accounts_noted: dict[str, int] = {}
        self._copies_noted: dict[tuple[int, ...], int] = {}
        self._copies = 0
        self._posted: dict[int, int] = {}  # number of a transfer → of this core's copies, the latest
        self._events = np.zeros(0, np.int64)
        self._present: tuple[int, bool] = (
            0,
            False,
        )  # the call that is made: its number, and whether it may leave L1
        self._result: Any = None  # of the last call that has waited
        self._begin()

    def _begin(self) -> None:
        self._operations: list[tuple[int, int, int, int, int]] = []
        self._accesses: list[tuple[Any, Any]] = []
        self._counted: list[tuple[int, Any, Any]] = []
        self._noted: list[tuple[str, tuple[Any, ...]]] = []
        self._new_accounts: list[str] = []
        self._new_copies: list[tuple[int, ...]] = []

    # Kernels

    def run(self, kernel: Kernel, *arguments: Row | int) -> Work:
        """Run a kernel as every core does."""
        try:
            call = self._calls.known[kernel, kernel.arrays_of(arguments)]
        except (LookupError, TypeError, AttributeError):  # the first time, or something is wrong
            call = self._calls.prepare(kernel, arguments)
        number = self._prepared.get(id(call))
        if number is None:
            number = self._prepared[id(call)] = len(self._prepared)
            rows = [each for each in arguments if isinstance(each, Row)]
            in_l1 = [each.is_in_l1 for each in rows]
            self._note("prepare", kernel.function.symbol, in_l1, *map(self._place, rows))
        self._present = number, not call.stays_in_l1
        return super().run(kernel, *arguments)

    def _charge_work(self, work: Work, stalls: dict[StallReason, int], account: Account) -> None:
        interlocks = work.stall_cclk
        super()._charge_work(work, stalls, account)
        if account is not self._account.of(""):
            return  # part of a call that is noted as a whole
        number, may_leave = self._present
        if may_leave:
            entries = (
                self._access_trace.entries(work.accesses).copy(),
                self._access_trace.sites(work.accesses).copy(),
            )
            self._accesses.append(entries)
            self._operations.append((w.ACCESS, work.issue_cclk, interlocks, work.accesses, number))
        elif self._operations and self._operations[-1][0] == w.RUN:
            _, issue, before, _, _ = self._operations[-1]
            self._operations[-1] = (w.RUN, issue + work.issue_cclk, before + interlocks, 0, 0)
        else:
            self._operations.append((w.RUN, work.issue_cclk, interlocks, 0, 0))

    # Rings

    def catch_up(self) -> simpy.Event | None:
        """Catch up as every core does."""
        if not self._inside:
            self._operations.append((w.CATCH_UP, 0, 0, 0, 0))
        return super().catch_up()

    def sync(self) -> Wait:
        """Catch up as every core does."""
        with self._as_a_whole():
            yield from super().sync()

    def has(self, transfer: Transfer) -> bool:  # noqa: ARG002
        """Let every wait be asked for, also of what is there already: on other hardware it may not be."""
        return False

    def wait_transfer(self, transfer: Transfer, reason: StallReason, owner: str) -> Wait:
        """Wait as every core does."""
        if not self._inside:
            number = self._posted.get(transfer.number)
            if number is None:
                self._on_obstacle(
                    f"core {self.name} waits for a copy behind which it has started more than {LATEST:,}"
                )
            else:
                back = self._copies - number
                self._operations.append((w.AWAIT, back, COUNTER_OF[reason], self._account_of(owner), 0))
        with self._as_a_whole():
            yield from super().wait_transfer(transfer, reason, owner)

    def program_device(self, owner: str, *, writes: int, reads: int = 0) -> None:
        """Write and read registers as every core does."""
        if not self._inside:
            self._operations.append((w.SET_UP, writes, reads, self._account_of(owner), 0))
        super().program_device(owner, writes=writes, reads=reads)

    def _note_copy(self, stream: int, source: Row, destination: Row, transfer: Transfer) -> None:
        copy = stream, *self._byte(source), *self._byte(destination), source.nbytes
        if copy not in self._copies_noted:
            self._copies_noted[copy] = len(self._copies_noted)
            self._new_copies.append(copy)
        self._posted[transfer.number] = self._copies
        self._copies += 1
        if len(self._posted) > LATEST:
            del self._posted[next(iter(self._posted))]
        self._operations.append((w.COPY, self._copies_noted[copy], 0, 0, 0))

    def _account_of(self, owner: str) -> int:
        if owner not in self._accounts_noted:
            self._accounts_noted[owner] = len(self._accounts_noted)
            if len(self._accounts_noted) > w.MAX_ACCOUNTS:
                self._on_obstacle(f"core {self.name} has rings in more than {w.MAX_ACCOUNTS} buffers")
            self._new_accounts.append(owner)
        return self._accounts_noted[owner]

    # Calls of firmware that are noted as a whole

    def _enter(self, stage: str) -> None:
        self._note("stage", stage)
        super()._enter(stage)

    def next_frame(self) -> Generator[Any, Any, Frame | None]:
        """Take the next frame as every core does."""
        return self._taken(super().next_frame())

    def _taken(self, wait: Generator[Any, Any, Frame | None]) -> Generator[Any, Any, Frame | None]:
        self._note("end_frame")
        self._hand_over()
        frame: Frame | None = yield from self._whole(wait)
        place = self._place(frame.rows[0]) if frame else Place(0, 0, 0)
        self._note("next_frame", frame.index if frame else -1, place)
        if frame and any(name.startswith("ppi_words_lost_") for name in self._results):
            self._on_obstacle(
                f"in frame {frame.index} the DMA of a camera lost words, and what was seen depends on which"
            )
        return frame

    def publish(self, **results: int) -> None:
        """Publish as every core does."""
        if not self._inside:
            self._note("publish", {name: int(each) for name, each in results.items()})
        super().publish(**results)

    def remark(self, text: str) -> None:
        """Remark as every core does."""
        self._note("remark", text)
        super().remark(text)

    def set_camera(self, settings: CameraSettings) -> None:
        """Set the camera as every core does."""
        self._note("set_camera", asdict(settings))
        super().set_camera(settings)

    def set_picture_size(self, size: FrameSize) -> None:
        """Set the size of the pictures as every core does."""
        self._note("set_picture_size", size.width_px, size.height_px)
        super().set_picture_size(size)

    def post(self, name: str) -> Wait:
        """Post as every core does."""
        return self._called(super().post(name), "post", name)

    def wait(self, name: str) -> Wait:
        """Wait as every core does."""
        return self._called(super().wait(name), "wait", name, lambda: self._semaphore(name).taken)

    def lock(self, name: str) -> Wait:
        """Lock as every core does."""
        return self._called(super().lock(name), "lock", name, lambda: self._lock(name).taken)

    def unlock(self, name: str) -> Wait:
        """Unlock as every core does."""
        return self._called(super().unlock(name), "unlock", name)

    def interrupt_core(self, other: str) -> Wait:
        """Interrupt another core as every core does."""
        return self._called(super().interrupt_core(other), "interrupt_core", other)

    def send(self, row: Row, nbytes: int, over: str = SPI) -> Wait:
        """Send as every core does."""
        octets = row.octets[:nbytes].tobytes().hex()
        return self._called(super().send(row, nbytes, over), "send", self._place(row), octets, over)

    def receive(self, row: Row, over: str = SPI) -> Generator[Any, Any, int]:
        """Receive as every core does."""
        wait = super().receive(row, over)
        return self._called(wait, "receive", self._place(row), lambda: self._received(row), over)

    def _received(self, row: Row) -> str:
        return row.octets[: self._result].tobytes().hex()

    def ppi_status(self) -> Generator[Any, Any, int]:
        """Read PPI_STATUS as every core does."""
        return self._called(super().ppi_status(), "ppi_status", lambda: self._result)

    def on_interrupt(self, source: str, handler: Handler) -> None:
        """Attach a handler as every core does."""
        self._on_obstacle(
            f"core {self.name} has a handler of the interrupt {source}, which comes when the hardware has it"
        )
        super().on_interrupt(source, handler)

    def memory_dma(self, name: str) -> MemoryDma:
        """Return a stream as every core does."""
        self._on_obstacle(f"core {self.name} programs {name} by addresses")
        return super().memory_dma(name)

    def _perform(self, task: Generator[Any, Any, Any]) -> Generator[Any, Any, None]:
        yield from super()._perform(task)
        self._note("end_frame")
        self._hand_over()

    # Inside

    @contextmanager
    def _as_a_whole(self) -> Iterator[None]:
        self._inside += 1
        yield
        self._inside -= 1

    def _whole(self, wait: Wait) -> Wait:
        with self._as_a_whole():
            result = yield from wait
        return result

    def _called(self, wait: Wait, name: str, *arguments: Any) -> Wait:
        """Note a call that has waited; those of its `arguments` that are functions give what is known then."""
        self._result = yield from self._whole(wait)
        self._note(name, *(each() if callable(each) else each for each in arguments))
        return self._result

    def _note(self, name: str, *arguments: Any) -> None:
        """Note a call, with what the kernels have counted until then."""
        now = self._calls.events.copy()
        since = now.copy()
        since[: len(self._events)] -= self._events
        counters = np.flatnonzero(since)
        self._counted.append((len(self._noted), counters, since[counters]))
        self._events = now
        self._operations.append((CALL, 0, 0, 0, 0))
        self._noted.append((name, arguments))

    def _hand_over(self) -> None:
        """Hand what was noted over, and begin anew."""
        count = sum(len(entries) for entries, _ in self._accesses)
        entries, sites = (
            np.concatenate([each[side] for each in self._accesses] or [np.zeros(0, np.int64)])
            for side in (0, 1)
        )
        offsets = entries & log.OFFSET_MASK
        owners = self._bus.owners.of_all(offsets)
        columns = np.empty((ACCESS_COLUMNS, count), np.uint32)
        columns[:] = (
            entries >> log.STAMP_BIT, entries >> log.KIND_BIT & log.KIND_MASK, owners,
            offsets - np.array(self._bus.owners.first)[owners], sites,
        )  # fmt: skip
        events = [
            np.column_stack([np.full(len(each), number), each, since])
            for number, each, since in self._counted
        ]
        self._on_work(
            FrameWork(
                core=self.name,
                operations=np.array(self._operations, np.int64).reshape(-1, w.OPERATION_WORDS),
                accesses=columns.T,
                events=np.concatenate(events or [np.zeros((0, 3), np.int64)]),
                copies=np.array(self._new_copies, np.int64).reshape(-1, COPY_COLUMNS),
                calls=tuple(self._noted),
                accounts=tuple(self._new_accounts),
            )
        )
        self._begin()

    def _byte(self, row: Row) -> tuple[int, int]:
        owner = self._bus.owners.of(row.offset)
        return owner, row.offset - self._bus.owners.first[owner]

    def _place(self, row: Row) -> Place:
        return Place(*self._byte(row), row.nbytes)
