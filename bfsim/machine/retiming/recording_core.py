"""A core that works as every core does, and notes what its firmware has it do as `FrameWork`."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import asdict
from typing import Any

from bfsim.kernel import Kernel
from bfsim.machine.buffers import FrameSize
from bfsim.machine.bus import state as w
from bfsim.machine.cameras.settling import CameraSettings
from bfsim.machine.core.core import SPI, Core
from bfsim.machine.core.interrupts import CoreHandler
from bfsim.machine.core.parts import Parts
from bfsim.machine.core.pictures.frames import Frame
from bfsim.machine.dma.memory_dma import MemoryDma
from bfsim.machine.memories import Row
from bfsim.machine.retiming.recorded_ahead import LATEST, RecordedAhead
from bfsim.machine.retiming.work import STAGE, FrameWork, Place

Wait = Generator[Any, Any, Any]


class RecordingCore(Core):
    """A core that hands its work to `on_work`, frame by frame, and anything that cannot be replayed to `on_obstacle`, in words."""

    def __init__(
        self, parts: Parts, on_work: Callable[[FrameWork], None], on_obstacle: Callable[[str], None]
    ) -> None:
        super().__init__(parts)
        assert isinstance(parts.progress, RecordedAhead), "what is recorded runs ahead"
        self._progress = parts.progress
        self._notes = parts.progress.notes
        self._on_work = on_work
        self._on_obstacle = on_obstacle
        self._result: Any = None  # of the last call that waited
        self._set: dict[str, tuple[Any, ...]] = {}  # the camera's settings, by call
        parts.calls.on_prepared = self._note_prepared

    def end(self) -> None:
        """Hand over the work since the last picture: the run is over."""
        self._note("end_frame")
        self._hand_over()

    # ---- kernels

    def _note_prepared(self, kernel: Kernel, arguments: tuple[Row | int, ...]) -> None:
        rows = [each for each in arguments if isinstance(each, Row)]
        in_l1 = [each.is_in_l1 for each in rows]
        self._note("prepare", kernel.function.symbol, in_l1, *map(self._notes.place, rows))

    def _enter(self, stage: str) -> None:
        self._notes.add_mark(self._parts.calls.events)
        self._progress.mark(STAGE, self._notes.stage(stage))
        super()._enter(stage)

    # ---- pictures

    def next_frame(self) -> Generator[Any, Any, Frame | None]:
        """Take the next frame as every core does."""
        return self._taken(super().next_frame())

    def _taken(self, wait: Generator[Any, Any, Frame | None]) -> Generator[Any, Any, Frame | None]:
        yield from self._progress.play_stretches()
        self.end()
        frame: Frame | None = yield from self._whole(wait)
        place = self._notes.place(frame.rows[0]) if frame else Place(0, 0, 0)
        self._note("next_frame", frame.index if frame else -1, place)
        if frame and self._parts.pictures.has_lost_words:
            self._on_obstacle(
                f"in frame {frame.index} the DMA of a camera lost words, and what was seen depends on which"
            )
        return frame

    def publish(self, **results: int) -> None:
        """Publish as every core does."""
        super().publish(**results)
        self._notes.publish(results)

    def remark(self, text: str) -> None:
        """Remark as every core does."""
        self._note("remark", text)
        super().remark(text)

    def set_camera(self, settings: CameraSettings) -> None:
        """Set the camera as every core does."""
        self._note_change("set_camera", asdict(settings))
        super().set_camera(settings)

    def set_picture_size(self, size: FrameSize) -> None:
        """Set the size of the pictures as every core does."""
        self._note_change("set_picture_size", size.width_px, size.height_px)
        super().set_picture_size(size)

    def ppi_status(self) -> Generator[Any, Any, int]:
        """Read PPI_STATUS as every core does."""
        return self._called(super().ppi_status(), "ppi_status", lambda: self._result)

    # ---- the other core

    def post(self, name: str) -> Wait:
        """Post as every core does."""
        return self._called(super().post(name), "post", name)

    def wait(self, name: str) -> Wait:
        """Wait as every core does."""
        semaphore = self._parts.shared.semaphore(name)
        return self._called(super().wait(name), "wait", name, lambda: semaphore.taken)

    def lock(self, name: str) -> Wait:
        """Lock as every core does."""
        lock = self._parts.shared.lock(name)
        return self._called(super().lock(name), "lock", name, lambda: lock.taken)

    def unlock(self, name: str) -> Wait:
        """Unlock as every core does."""
        return self._called(super().unlock(name), "unlock", name)

    def interrupt_core(self, other: str) -> Wait:
        """Interrupt another core as every core does."""
        return self._called(super().interrupt_core(other), "interrupt_core", other)

    # ---- messages

    def send(self, row: Row, nbytes: int, over: str = SPI) -> Wait:
        """Send as every core does."""
        octets = row.octets[:nbytes].tobytes().hex()
        return self._called(super().send(row, nbytes, over), "send", self._notes.place(row), octets, over)

    def receive(self, row: Row, over: str = SPI) -> Generator[Any, Any, int]:
        """Receive as every core does."""
        wait = super().receive(row, over)
        return self._called(wait, "receive", self._notes.place(row), lambda: self._received(row), over)

    def _received(self, row: Row) -> str:
        return row.octets[: self._result].tobytes().hex()

    # ---- what cannot be played again

    def on_interrupt(self, source: str, handler: CoreHandler) -> None:
        """Attach a handler as every core does."""
        self._on_obstacle(
            f"core {self.name} has a handler of the interrupt {source}, which comes when the hardware has it"
        )
        super().on_interrupt(source, handler)

    def memory_dma(self, name: str) -> MemoryDma:
        """Return a stream as every core does."""
        self._on_obstacle(f"core {self.name} programs {name} by addresses")
        return super().memory_dma(name)

    # ---- notes

    def _whole(self, wait: Wait) -> Wait:
        """Wait without noting the parts of the wait."""
        yield from self._progress.play_stretches()
        self._progress.is_paused = True
        result = yield from wait
        self._progress.is_paused = False
        return result

    def _called(self, wait: Wait, name: str, *arguments: Any) -> Wait:
        """Note a call after its wait. Those of its `arguments` that are functions return values known only then."""
        self._result = yield from self._whole(wait)
        self._note(name, *(each() if callable(each) else each for each in arguments))
        return self._result

    def _note(self, name: str, *arguments: Any) -> None:
        """Note a call, with the kernels' counts up to it."""
        self._notes.add_mark(self._parts.calls.events)
        self._notes.add_call(name, arguments)
        self._progress.mark()

    def _note_change(self, name: str, *arguments: Any) -> None:
        """Note a call that changes nothing if it is repeated."""
        if self._set.get(name) != arguments:
            self._set[name] = arguments
            self._note(name, *arguments)

    def _hand_over(self) -> None:
        if self._progress.is_too_late:
            self._on_obstacle(
                f"core {self.name} waits for a copy behind which it has started more than {LATEST:,}"
            )
        if self._notes.accounts > w.MAX_ACCOUNTS:
            self._on_obstacle(f"core {self.name} has rings in more than {w.MAX_ACCOUNTS} buffers")
        self._on_work(self._notes.take())
