"""The loader: lays out the firmware's buffers where the linker placed them, and knows who owns which memory."""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Iterator, Mapping, Sequence

from bfsim.chip.spec import BoardSpec
from bfsim.errors import FirmwareError
from bfsim.linker import LinkMap
from bfsim.machine.buffers import Buffer, FrameSize
from bfsim.machine.bus.memory_owners import MemoryOwner, MemoryOwners
from bfsim.machine.cameras.capture import Pair
from bfsim.machine.memories import Memories, Row
from bfsim.machine.program import Firmware
from bfsim.machine.symbols import PROCESSORS, require_cores
from bfsim.trace import BufferRecord

Rows = tuple[Row, ...]


class LoadedBuffers:
    """The buffers of a firmware in the memories of a board. `of` has the buffers that each core knows, by name, as rows."""

    def __init__(
        self,
        spec: BoardSpec,
        firmware: Firmware,
        size: FrameSize,
        link_map: LinkMap,
        memories: Memories,
        owners: MemoryOwners,
    ) -> None:
        """Registers every buffer with `owners`. Raises FirmwareError if the firmware is for other cores."""
        require_cores(firmware, spec)
        self._cores = spec.chip.cores
        self._firmware = firmware
        self._size = size
        placed = {
            owner: {
                each.name: memories.place(each, link_map.find(PROCESSORS[owner], each.name))
                for each in buffers
            }
            for owner, buffers in firmware.buffers(size).items()
        }
        self.records = tuple(_own(placed, owners))
        shared = placed.get("shared", {})
        self._own_names = {core: set(placed.get(core, {})) for core in self._cores}
        self.handed_over = frozenset(
            each.name for each in firmware.buffers(size).get("shared", ()) if each.handed_over
        ) - {firmware.camera}
        """The shared buffers that only one core at a time works on."""
        self.of: dict[str, dict[str, Rows]] = {core: shared | placed.get(core, {}) for core in self._cores}

    def only_of(self, core: str) -> frozenset[str]:
        """Return the buffers that only this core works on: no other core knows them, and no camera writes them."""
        return frozenset(self._own_names[core] - {self._firmware.camera})

    def declared(self, core: str, size: FrameSize) -> dict[str, Buffer]:
        """Return the buffers that a core knows by name, as the firmware declares them for pictures of `size`."""
        buffers = self._firmware.buffers(size)
        return {each.name: each for owner in ("shared", core) for each in buffers.get(owner, ())}

    def frame_buffers(self) -> list[Pair]:
        """Split the camera buffer of each core into frames. Frame n of every core makes pair n."""
        name, height, line_nbytes = self._firmware.camera, self._size.height_px, 2 * self._size.width_px
        rows = {core: self.of[core].get(name, ()) for core in self._cores}
        lengths = {len(each) for each in rows.values()}
        count = min(lengths) // height
        wrong_row = any(each[0].nbytes != line_nbytes for each in rows.values() if each)
        if not count or lengths != {count * height} or wrong_row:
            without = ", ".join(core for core, each in rows.items() if not each)
            found = {f"{len(each)} rows of {each[0].nbytes} bytes": None for each in rows.values() if each}
            had = f"; there is none of that name for {without}" if without else f", not {' and '.join(found)}"
            raise FirmwareError(
                f"the camera buffer {name!r} of each core must have a multiple of {height} rows of {line_nbytes} bytes{had}"
            )
        for each in rows.values():
            if "SCRATCH" in each[0].memory:
                raise FirmwareError(f"{name} must be where DMA can reach it, not in {each[0].memory}")
        return [
            Pair({core: each[number * height : (number + 1) * height] for core, each in rows.items()})
            for number in range(count)
        ]


def _own(placed: Mapping[str, Mapping[str, Sequence[Row]]], owners: MemoryOwners) -> Iterator[BufferRecord]:
    """Let every buffer own its memory, and yield its record."""
    declared = Tally(name for buffers in placed.values() for name in buffers)
    for owner, buffers in placed.items():
        for name, rows in buffers.items():
            record = BufferRecord(
                buffer=name if declared[name] == 1 else f"{name} ({owner})",
                core=owner,
                memory=rows[0].memory,
                address=rows[0].address,
                nbytes=sum(each.nbytes for each in rows),
            )
            owners.add(MemoryOwner(record.memory, record.buffer, record.nbytes), rows[0].offset)
            yield record
