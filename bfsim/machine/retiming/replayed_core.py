"""A core that repeats on its own hardware what a recorded core did. It runs no kernel, and moves no pixel that matters."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import BfsimError, WorkError, shown
from bfsim.kernel import Kernel
from bfsim.kernel.types import ArrayType, IntType
from bfsim.machine.buffers import FrameSize
from bfsim.machine.bus import state as w
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.cameras.settling import CameraSettings
from bfsim.machine.core.core import Core
from bfsim.machine.core.parts import Parts
from bfsim.machine.core.synchronisation.semaphore import Semaphore
from bfsim.machine.core.synchronisation.spin_lock import SpinLock
from bfsim.machine.memories import Row
from bfsim.machine.retiming.laid_dictionaries import IN_L1
from bfsim.machine.retiming.packed_work import PackedWork
from bfsim.machine.retiming.replayed_copies import ReplayedCopies
from bfsim.machine.retiming.replayed_places import ReplayedPlaces
from bfsim.machine.retiming.replayed_stages import ReplayedStages
from bfsim.machine.retiming.stretch_writer import StretchWriter
from bfsim.machine.retiming.work import Place
from bfsim.machine.retiming.work_check import not_there

NOT_THE_SAME = "what the cores do depends on the hardware, so the recorded run cannot be played on this one; run the firmware itself"

Wait = Generator[Any, Any, Any]


class ReplayedCore(Core):
    """A core that plays `works`. `kernels` are its firmware's, by symbol."""

    def __init__(self, parts: Parts, kernels: dict[str, Kernel], works: Iterator[PackedWork]) -> None:
        super().__init__(parts)
        assert isinstance(parts.bus, WovenBus), "recorded work is played by the weave"
        self._bus = parts.bus
        self._works = works
        self._kernels = kernels
        bus, chip = parts.bus, parts.board.chip
        self._places = ReplayedPlaces(bus.owners, parts.layouts.memories)
        self._copies = ReplayedCopies(bus.stretches, self._places, parts.rings.streams, chip.dma.word_bytes)
        firsts = self._places.firsts
        outside = np.where(firsts < int(bus.words[w.L2_END]), firsts, IN_L1)
        self._writer = StretchWriter(bus.words, parts.number, outside, chip.events)
        self._know(np.zeros(0, np.int64))
        self._account_names: list[str] = []
        self._stages = ReplayedStages(parts, parts.bus, self._writer.pass_mark)
        self._results: Mapping[str, int] = {}
        self._known_calls: dict[str, Callable[..., Wait | None]] = {
            "prepare": self._prepare,
            "end_frame": self._publish,
            "next_frame": self._take,
            "remark": self.remark,
            "set_camera": lambda settings: self.set_camera(CameraSettings(**settings)),
            "set_picture_size": lambda *size: self.set_picture_size(FrameSize(*size)),
            "post": parts.synchronisation.post,
            "unlock": parts.synchronisation.unlock,
            "wait": self._take_semaphore,
            "lock": self._take_lock,
            "interrupt_core": parts.synchronisation.interrupt_core,
            "send": self._send,
            "receive": self._receive,
            "ppi_status": self._read_status,
        }

    # The main loop

    def replay(self) -> Generator[Any, Any, None]:
        """Play the recorded work."""
        for work in self._works:
            try:
                yield from self._play_work(work)
            except BfsimError:
                raise
            except (
                LookupError,
                TypeError,
                ValueError,
                AttributeError,
                OverflowError,
            ) as error:  # a file may hold anything
                raise not_there(self.name, error) from error

    def _play_work(self, work: PackedWork) -> Wait:
        self._account_names += work.accounts
        self._stages.know(work.stages)
        self._stages.use(self._account_names)
        self._results = work.results
        self._copies.know(work.copies)
        writer = self._writer
        writer.begin(work, self._copies.rows, len(self._account_names), self._stages.count)
        for name, arguments in work.calls:
            yield from self._play_stretches()
            if not writer.is_at_call:
                raise ValueError("fewer calls of its firmware")
            writer.pass_mark()
            wait = self._known_calls[name](*arguments)
            if wait is not None:
                yield from wait
        yield from self._play_stretches()
        if writer.is_at_call:
            raise ValueError("more calls of its firmware")

    def _play_stretches(self) -> Wait:
        """Play the work before the next call of firmware: mostly one stretch, or nothing."""
        number, stages, frame = self._parts.number, self._stages, self._writer
        is_written = False
        while not is_written:
            must_look = stages.must_look
            operations = frame.write(*self._kinds_at, must_look=must_look)
            is_written = frame.is_at_call or frame.is_over
            if operations:
                yield self._bus.stretches.play(
                    number, self._parts.clock.cclk, len(self._account_names), operations
                )
                stages.charge()
            if must_look and not is_written:
                stages.look()

    def _know(self, kinds: NDArray[np.int64]) -> None:
        """Keep the kind of operation of each prepared call, and the array's address: numpy takes longer to find that than most stretches take."""
        self._kinds, self._kinds_at = kinds, (kinds.ctypes.data, len(kinds))
        self._writer.counters_at = self._parts.calls.counters_at

    # Calls of firmware, by their names in the notes

    def _publish(self) -> None:
        if not all(type(each) is int for each in self._results.values()):
            raise TypeError("a result that is no integer")
        self._pictures.publish(**self._results)

    def _take_semaphore(self, name: str, turn: int) -> Wait:
        yield from self._parts.synchronisation.wait(name)
        self._check_turn(self._parts.shared.semaphore(name), turn)

    def _take_lock(self, name: str, turn: int) -> Wait:
        yield from self._parts.synchronisation.lock(name)
        self._check_turn(self._parts.shared.lock(name), turn)

    def _check_turn(self, shared: Semaphore | SpinLock, turn: int) -> None:
        if shared.taken != turn:
            raise WorkError(
                f"the cores take {shared.name!r} in another order than when the run was recorded: {NOT_THE_SAME}"
            )

    def _send(self, place: Place, octets: str, over: str) -> Wait:
        row, sent = self._places.row(place), bytes.fromhex(octets)
        row.octets[: len(sent)] = sent
        yield from self._parts.messages.send(row, len(sent), over)

    def _receive(self, place: Place, octets: str, over: str) -> Wait:
        row = self._places.row(place)
        nbytes = yield from self._parts.messages.receive(row, over)
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
        frame = yield from self._pictures.next_frame()
        taken = frame.index if frame else -1
        if taken != index or (frame and frame.rows[0].offset != self._places.offset(place)):
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
                f"kernel {shown(symbol)} must stand in a module of the firmware to be found again: {NOT_THE_SAME}"
            )
        parameters = kernel.function.parameters
        rows = iter(places)
        arguments: list[Any] = [
            self._places.row(next(rows), each.type.element)
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


def played_again(core: Core) -> Generator[Any, Any, None]:
    """Play the recorded work: the main loop of every replayed core."""
    assert isinstance(core, ReplayedCore), "only a replayed core has something to play again"
    yield from core.replay()
