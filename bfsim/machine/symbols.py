"""What a firmware needs from the linker: a symbol for every buffer, and one for the code of every kernel."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from bfsim.chip.spec import BoardSpec
from bfsim.errors import BfsimError, FirmwareError, is_failure, shown
from bfsim.kernel.build import ESTIMATED, Build
from bfsim.linker import Symbol
from bfsim.machine.buffers import Buffer, Buffers, FrameSize
from bfsim.machine.code import code_symbols, object_file
from bfsim.machine.firmware_lines import failure_of, line_of, place_of
from bfsim.machine.program import Firmware

PROCESSORS: dict[str, str | None] = {"A": "p0", "B": "p1", "shared": None}  # names of the cores in an LDF


def require_cores(firmware: Firmware, spec: BoardSpec) -> None:
    """Raise FirmwareError unless the firmware is for the cores of the board's chip."""
    if set(firmware.mains) != set(spec.chip.cores):
        cores, known = ", ".join(spec.chip.cores), ", ".join(sorted(firmware.mains))
        idle = (
            "; that of a core without work only asks for the next frame"
            if set(firmware.mains) < set(spec.chip.cores)
            else ""
        )
        raise FirmwareError(
            f"firmware must have main loops for {cores}, not for {known} (board {spec.name}){idle}; --board takes another board, "
            "of those that `bfsim boards` lists"
        )


def symbols_of(firmware: Firmware, size: FrameSize, build: Build = ESTIMATED) -> list[Symbol]:
    """Return what the linker must place for pictures of `size`: buffers, and code as `build` makes it."""
    buffers = list(_of_buffers(firmware, size))  # first, because estimating the size of code takes seconds
    mains = firmware.mains.items()
    code = (each for owner, main in mains for each in code_symbols(main, PROCESSORS[owner], build))
    return [*code, *buffers]


def _of_buffers(firmware: Firmware, size: FrameSize) -> Iterator[Symbol]:
    place = place_of(firmware.buffers)
    for owner, buffers in _called(firmware, size).items():
        if owner not in PROCESSORS:
            raise FirmwareError(
                f"buffers must belong to {', '.join(PROCESSORS)}, not {shown(owner)} ({place})"
            )
        if not isinstance(buffers, Iterable):
            raise FirmwareError(f"buffers of {owner} must be a list of them, not {shown(buffers)} ({place})")
        for each in buffers:
            if not isinstance(each, Buffer):
                raise FirmwareError(
                    f"buffers of {owner} must be of bfsim.api.Buffer, not {shown(each)} ({place})"
                )
            if each.handed_over and (owner != "shared" or each.name == firmware.camera):
                raise FirmwareError(
                    f"buffer {each.name} of {owner} must not be handed over (handed_over=True): only a shared buffer that no camera fills is"
                )
            yield Symbol(
                name=each.name,
                section=each.section,
                nbytes=each.nbytes,
                processor=PROCESSORS[owner],
                object_file=object_file(each.name),
            )


def _called(firmware: Firmware, size: FrameSize) -> Buffers:
    """Return the firmware's buffers. A mistake in its code becomes a FirmwareError with the line."""
    try:
        buffers = firmware.buffers(size)
    except BfsimError as error:
        raise type(error)(f"{error}{line_of(error, firmware.buffers)}") from error
    except BaseException as error:
        if not is_failure(error):
            raise
        what = f"{failure_of(error)}{line_of(error, firmware.buffers)}"
        raise FirmwareError(f"buffers for pictures of {size} failed with {what}") from error
    if not isinstance(buffers, Mapping):
        forgotten = "; the function must end with `return`" if buffers is None else ""
        raise FirmwareError(
            f"buffers must come as a dict of those of each core, not as {shown(buffers)}{forgotten} ({place_of(firmware.buffers)})"
        )
    return buffers
