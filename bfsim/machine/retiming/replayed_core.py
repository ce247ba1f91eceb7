"""A core that does again what a recorded one did, on the hardware that it is part of. It runs no kernel, and moves no pixel that counts."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import BfsimError, WorkError, shown
from bfsim.kernel import Kernel
from bfsim.kernel.calls import access_log as log
from bfsim.kernel.types import ArrayType, IntType, Number, u8
from bfsim.machine.buffers import FrameSize
from bfsim.machine.bus import state as w
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.cameras.settling import CameraSettings
from bfsim.machine.core.core import Core
from bfsim.machine.core.parts import Parts
from bfsim.machine.core.synchronisation.semaphore import Semaphore
from bfsim.machine.core.synchronisation.spin_lock import SpinLock
from bfsim.machine.memories import Row
from bfsim.machine.retiming.packed_work import PackedWork
from bfsim.machine.retiming.stretch_writer import StretchWriter
from bfsim.machine.retiming.work import (
    DESTINATION,
    DESTINATION_BYTE,
    NBYTES,
    SOURCE,
    SOURCE_BYTE,
    STREAM,
    Place,
    Table,
)
from bfsim.machine.retiming.written_stretch import IN_L1

NOT_THE_SAME = "what the cores do depends on the hardware, so the recorded run cannot be played on this one; run the firmware itself"

Wait = Generator[Any, Any, Any]


class ReplayedCore(Core):
    """A core that plays `works`. `kernels`: those of its firmware, by symbol."""

    def __init__(self, parts: Parts, kernels: dict[str, Kernel], works: Iterator[PackedWork]) -> None:
        super().__init__(parts)
        assert isinstance(parts.bus, WovenBus), "recorded work is played by the weave"
        self._bus = parts.bus
        self._chip = parts.board.chip
        self._works = works
        self._kernels = kernels
        self._firsts = np.array(parts.bus.owners.first, np.int64)
        self._firsts_outside = np.where(self._firsts < int(parts.bus.words[w.L2_END]), self._firsts, IN_L1)
        self._know(np.zeros(0, np.int64))
        self._account_names: list[str] = []
        self._copies = np.zeros((0, 3), np.int64)
        self._plans: dict[int, int] = {}  # their numbers, by the kinds of copies
        self._known_calls: dict[str, Callable[..., Wait | None]] = {
            "prepare": self._prepare,
            "stage": self._enter,
            "end_frame": lambda: None,
            "next_frame": self._take,
            "publish": lambda results: self.publish(**results),
            "remark": self.remark,
            "set_camera": lambda settings: self.set_camera(CameraSettings(**settings)),
            "set_picture_size": lambda *size: self.set_picture_size(FrameSize(*size)),
            "post": self.post,
            "unlock": self.unlock,
            "wait": self._take_semaphore,
            "lock": self._take_lock,
            "interrupt_core": self.interrupt_core,
            "send": self._send,
            "receive": self._receive,
            "ppi_status": self._read_status,
        }

    # The main loop

    def replay(self) -> Generator[Any, Any, None]:
        """Do what was recorded."""
        for work in self._works:
            try:
                yield from self._play_work(work)
            except BfsimError:
                raise
            except (LookupError, TypeError, ValueError, OverflowError) as error:  # a file may hold anything
                raise WorkError(
                    f"the work of core {self.name} must be as it was recorded, but names what is not there: {shown(error)}"
                ) from error

    def _play_work(self, work: PackedWork) -> Wait:
        self._account_names += work.accounts
        if len(work.copies):
            self._copies = np.concatenate([self._copies, self._planned(work.copies)])
        copies, accounts = self._copies, len(self._account_names)
        frame = StretchWriter(
            self._bus.words,
            self._parts.number,
            work,
            self._firsts_outside,
            copies,
            accounts,
            self._chip.events,
        )
        for name, arguments in work.calls:
            yield from self._play_stretches(frame)
            wait = self._known_calls[name](*arguments)
            if wait is not None:
                yield from wait
        yield from self._play_stretches(frame)

    def _play_stretches(self, frame: StretchWriter) -> Wait:
        """Play what is done before the next call of firmware; most often that is one stretch, or nothing."""
        number, clock, stretches = self._parts.number, self._parts.clock, self._bus.stretches
        owners, accounts = self._account_names, len(self._account_names)
        operations = w.MAX_OPERATIONS
        while operations == w.MAX_OPERATIONS:
            operations = frame.write(*self._kinds_at, *self._parts.calls.counters_at)
            if operations:
                yield stretches.play(number, clock.cclk, accounts, operations)
                clock.stretch(stretches.played(number, accounts), owners)

    def _know(self, kinds: NDArray[np.int64]) -> None:
        """Keep of each call that is prepared what running it is to the bus; numpy takes longer to find its address than most stretches do."""
        self._kinds, self._kinds_at = kinds, (kinds.ctypes.data, len(kinds))

    def _planned(self, copies: Table) -> Table:
        """Plan copies; return the numbers of their plans, and where they go from and to: rows of what is behind COPY.

        Those of a kind differ only in where they go.
        """
        owners, word_bytes = copies[:, [SOURCE, DESTINATION]].T, self._chip.dma.word_bytes
        sources, destinations = self._firsts[owners] + copies[:, [SOURCE_BYTE, DESTINATION_BYTE]].T
        kinds = copies[:, STREAM]  # and all else that they have in common, in one number
        for more, room in (
            (owners[0], w.MAX_OWNERS),
            (owners[1], w.MAX_OWNERS),
            (copies[:, NBYTES], log.OFFSET_MASK + 1),
        ):
            kinds = kinds * room + more
        kinds = kinds * word_bytes + (sources | destinations) % word_bytes
        found, examples, kind_of = np.unique(kinds, return_index=True, return_inverse=True)
        for kind, example in zip(found.tolist(), examples.tolist(), strict=True):
            if kind not in self._plans:
                (self._plans[kind],) = self._bus.stretches.keep_plans([self._plan(*copies[example].tolist())])
        plans = np.array([self._plans[each] for each in found.tolist()])
        return np.stack([plans[kind_of], sources, destinations], axis=1)

    def _plan(
        self, stream: int, source: int, from_byte: int, destination: int, to_byte: int, nbytes: int
    ) -> tuple[int, ...]:
        rows = self._row(Place(source, from_byte, nbytes)), self._row(Place(destination, to_byte, nbytes))
        for each in rows:
            if "SCRATCH" in each.memory:
                raise WorkError(f"{each.buffer} must be where DMA can reach it, not in {each.memory}")
        return self._parts.rings.streams[stream].plan(*rows).words

    # Calls of firmware, by the name that they are noted by

    def _take_semaphore(self, name: str, turn: int) -> Wait:
        yield from self.wait(name)
        self._check_turn(self._parts.shared.semaphore(name), turn)

    def _take_lock(self, name: str, turn: int) -> Wait:
        yield from self.lock(name)
        self._check_turn(self._parts.shared.lock(name), turn)

    def _check_turn(self, shared: Semaphore | SpinLock, turn: int) -> None:
        if shared.taken != turn:
            raise WorkError(
                f"the cores take {shared.name!r} in another order than when the run was recorded: {NOT_THE_SAME}"
            )

    def _send(self, place: Place, octets: str, over: str) -> Wait:
        row, sent = self._row(place), bytes.fromhex(octets)
        row.octets[: len(sent)] = sent
        yield from self.send(row, len(sent), over)

    def _receive(self, place: Place, octets: str, over: str) -> Wait:
        row = self._row(place)
        nbytes = yield from self.receive(row, over)
        if row.octets[:nbytes].tobytes().hex() != octets:
            raise WorkError(
                f"a message of the device on the {over} comes earlier or later than when the run was recorded: {NOT_THE_SAME}"
            )

    def _read_status(self, before: int) -> Wait:
        status = yield from self.ppi_status()
        if status != before:
            raise WorkError(
                f"PPI_STATUS of core {self.name} is another one than when the run was recorded: {NOT_THE_SAME}"
            )

    def _take(self, index: int, place: Place) -> Wait:
        frame = yield from self.next_frame()
        taken = frame.index if frame else -1
        if taken != index or (frame and frame.rows[0].offset != self._offset(place)):
            got, had = (f"frame {each}" if each >= 0 else "no more frame" for each in (taken, index))
            where = ", in another frame buffer" if taken == index else ""
            raise WorkError(
                f"core {self.name} gets {got}{where} where it got {had} when the run was recorded, for others are missed here: {NOT_THE_SAME}"
            )
        if self._parts.pictures.has_lost_words:
            raise WorkError(
                f"in frame {index} the DMA of a camera loses words on this hardware: {NOT_THE_SAME}"
            )

    def _prepare(self, symbol: str, in_l1: list[bool], *places: Place) -> None:
        kernel = self._kernels.get(symbol)
        if kernel is None:
            raise WorkError(
                f"kernel {symbol} must stand in a module of the firmware to be found again: {NOT_THE_SAME}"
            )
        parameters = kernel.function.parameters
        rows = iter(places)
        arguments: list[Any] = [
            self._row(next(rows), each.type.element)
            if isinstance(each.type, ArrayType)
            else (0 if isinstance(each.type, IntType) else 0.0)
            for each in parameters
        ]
        stays_in_l1 = self._parts.calls.expect(kernel, tuple(arguments), was_traced=not all(in_l1))
        given = [each for each in arguments if isinstance(each, Row)]
        moved_out = [each.buffer for each, was in zip(given, in_l1, strict=True) if was and not each.is_in_l1]
        if moved_out:
            raise WorkError(
                f"{', '.join(dict.fromkeys(moved_out))} must be in L1, for it was when the run was recorded, and of what lies there "
                "the accesses are not; record a run with this LDF, which can be played where it is in L1, too"
            )
        self._know(np.append(self._kinds, w.RUN if stays_in_l1 else w.ACCESS))

    def _offset(self, place: Place) -> int:
        return int(self._firsts[place.owner]) + place.first

    def _row(self, place: Place, element: Number = u8) -> Row:
        """Return the row at a place, of elements of a kind."""
        owner = self._bus.owners[place.owner]
        array = self._parts.layouts.memories.bytes_from(self._offset(place), place.nbytes).view(element.dtype)
        return Row(owner.buffer, owner.memory, 0, self._offset(place), array)


def played_again(core: Core) -> Generator[Any, Any, None]:
    """Play what was recorded: the main loop of every replayed core."""
    assert isinstance(core, ReplayedCore), "only a replayed core has something to play again"
    yield from core.replay()
