"""How a core is assembled from its parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from bfsim.chip.spec import BoardSpec
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.masters import RING_STREAMS
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.calls.call_cache import CallCache
from bfsim.machine.cameras.capture import Capture
from bfsim.machine.core.buffers.layouts import Layouts
from bfsim.machine.core.buffers.line_rings import LineRings
from bfsim.machine.core.clock.clock import CoreClock
from bfsim.machine.core.messages import Messages
from bfsim.machine.core.parts import Parts
from bfsim.machine.core.pictures.pictures import Pictures
from bfsim.machine.core.pictures.readout import Readout
from bfsim.machine.core.progress.ahead import Ahead
from bfsim.machine.core.progress.in_step import InStep
from bfsim.machine.core.progress.progress import Progress
from bfsim.machine.core.progress.told_ahead import ToldAhead
from bfsim.machine.core.stages import Stages
from bfsim.machine.core.synchronisation.shared_objects import SharedObjects
from bfsim.machine.core.synchronisation.synchronisation import Synchronisation
from bfsim.machine.core.tasks.tasks import Tasks
from bfsim.machine.core.waits import Waits
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.dma.memory_dma import Dma
from bfsim.machine.peripherals.peripheral import Peripheral
from bfsim.machine.simulation import Simulation
from bfsim.seen import Seen


@dataclass(frozen=True, slots=True, kw_only=True)
class AroundCores:
    """What a board has for its cores. `stages` are its firmware's; `ahead` is the progress of cores that may run ahead.

    `on_finished` is called when a core ends a frame. `view` reads out what was seen, if anyone wants to know.
    """

    env: Simulation
    board: BoardSpec
    bus: Bus
    shared: SharedObjects
    capture: Capture
    dma: Dma
    peripherals: Mapping[str, Peripheral]
    stages: tuple[str, ...]
    ahead: type[Ahead] | None
    on_finished: Callable[[], None]
    view: Callable[[Readout], Seen | None] | None


def parts_of(
    around: AroundCores, number: int, layouts: Layouts, access_trace: AccessTrace, calls: CallCache
) -> Parts:
    """Assemble the core with this `number` from its own memory, access trace and calls."""
    env, bus, chip, shared = around.env, around.bus, around.board.chip, around.shared
    name = layouts.core
    clock = CoreClock(env, name, around.board, bus, around.stages)
    in_step = InStep(env, bus, number, clock, shared.interrupts[name], Waits(name))
    progress: Progress = in_step
    if around.ahead and isinstance(bus, WovenBus):
        tape = bus.tape(number)
        told = ToldAhead(clock.timeline, bus, tape, calls.made) if clock.timeline else None
        progress = around.ahead(env, in_step, name, number, bus, tape, access_trace, chip.events, told)
    tasks = Tasks(name, progress, calls, shared.handovers, chip.events)
    in_step.serve_interrupts = tasks.serve_interrupts
    pictures = Pictures(
        chip, progress, tasks, calls, around.capture, access_trace, layouts, around.on_finished, around.view
    )
    inward, outward = (MdmaStream(bus, around.board, each) for each in RING_STREAMS[number])
    return Parts(
        name=name,
        number=number,
        board=around.board,
        bus=bus,
        clock=clock,
        progress=progress,
        calls=calls,
        tasks=tasks,
        stages=Stages(around.stages, progress, calls, bus),
        pictures=pictures,
        layouts=layouts,
        rings=LineRings(progress, (inward, outward), layouts, access_trace, pictures.take_line),
        messages=Messages(progress, around.peripherals),
        synchronisation=Synchronisation(env, name, number, chip, bus, progress, shared, tasks.check_claimed),
        shared=shared,
        capture=around.capture,
        dma=around.dma,
    )
