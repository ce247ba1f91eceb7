"""The parts of a core. Firmware sees none of them: it gets a `Core`, which delegates to them."""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus.bus import Bus
from bfsim.machine.calls.call_cache import CallCache
from bfsim.machine.cameras.capture import Capture
from bfsim.machine.core.buffers.layouts import Layouts
from bfsim.machine.core.buffers.line_rings import LineRings
from bfsim.machine.core.clock.clock import CoreClock
from bfsim.machine.core.messages import Messages
from bfsim.machine.core.pictures.pictures import Pictures
from bfsim.machine.core.progress.progress import Progress
from bfsim.machine.core.stages import Stages
from bfsim.machine.core.synchronisation.shared_objects import SharedObjects
from bfsim.machine.core.synchronisation.synchronisation import Synchronisation
from bfsim.machine.core.tasks.tasks import Tasks
from bfsim.machine.dma.memory_dma import Dma


@dataclass(frozen=True, slots=True, kw_only=True)
class Parts:
    """The parts of core `name`, which has that `number` on the bus. The cores share `shared`, `capture` and `dma`."""

    name: str
    number: int
    board: BoardSpec
    bus: Bus
    clock: CoreClock
    progress: Progress
    calls: CallCache
    tasks: Tasks
    stages: Stages
    pictures: Pictures
    layouts: Layouts
    rings: LineRings
    messages: Messages
    synchronisation: Synchronisation
    shared: SharedObjects
    capture: Capture
    dma: Dma
