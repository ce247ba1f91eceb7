"""One link without a run: LDF + firmware + board → the memory map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from bfsim.chip.spec import BoardSpec
from bfsim.linker import CORE_OF_PROCESSOR, LinkerScript, link
from bfsim.loading.firmware import load_firmware
from bfsim.loading.given import given_firmware
from bfsim.loading.hardware import find_board, find_profile
from bfsim.machine.buffers import Buffer, FrameSize
from bfsim.machine.program import Calibration, Firmware
from bfsim.machine.symbols import PROCESSORS, symbols_of
from bfsim.report.ldf.map import ContentKind, MemoryMap
from bfsim.report.ldf.map_builder import BoardMemories, memory_map
from bfsim.running.building import build_for
from bfsim.running.inputs import read_placement


def map_memory(
    ldf: Path | None = None,
    *,
    firmware: Firmware | str,
    board: str | BoardSpec,
    settings: Mapping[str, object] = MappingProxyType({}),
    profile: str,
    width_px: int,
    height_px: int,
    defines: Mapping[str, str] = MappingProxyType({}),
    include_dirs: Sequence[Path] = (),
    calibration: Calibration | None = None,
) -> MemoryMap:
    """Return where the LDF, or without one the board's, puts `firmware`.

    Pictures have the given size, and come from cameras that a `calibration` knows. Firmware for other cores than the
    LDF's is left out, and the map then shows the LDF alone. Raises a BfsimError if anything given is wrong, or if the
    firmware does not fit.
    """
    spec, compiler = find_board(board, settings).value, find_profile(profile).value
    script = read_placement(ldf, spec, defines, include_dirs)
    loaded = given_firmware(firmware) if isinstance(firmware, Firmware) else load_firmware(firmware)
    size = FrameSize(width_px, height_px)
    program = loaded.firmware if calibration is None else loaded.firmware.calibrated(calibration)
    why_without = _misfit(program, script, spec)
    link_map, kinds = None, {}
    if not why_without:
        with loaded.own.named():
            symbols, kinds = symbols_of(program, size, build_for(loaded, compiler)), _kinds(program, size)
        link_map = link(script, symbols, spec.chip.regions, chip=spec.chip.name)
    return memory_map(
        script,
        link_map,
        _memories(script, spec),
        kinds,
        firmware="" if why_without else loaded.name,
        width_px=width_px,
        height_px=height_px,
        why_without=why_without,
    )


def _misfit(firmware: Firmware, script: LinkerScript, spec: BoardSpec) -> str:
    """Return why the firmware cannot be in the map: LDF, board and firmware are not about the same cores; else ""."""
    if not _is_of_chip(script, spec):
        return f"the LDF is for an {script.chip}, the board {spec.name} has an {spec.chip.name}"
    mains, cores = sorted(firmware.mains), sorted(spec.chip.cores)
    if mains != cores:
        return f"its main loops are for {_and(mains)}, the cores of {spec.name} are {_and(cores)}"
    processors = sorted({name for block in script.blocks for name in block.processors})
    if sorted(script.core_of_processor.get(name, name) for name in processors) != cores:
        wanted = [name for name, core in CORE_OF_PROCESSOR.items() if core in cores]
        return f"the PROCESSORs of the LDF must be {_and(wanted)}, not {_and(processors) or 'none'}"
    return ""


def _and(names: Sequence[str]) -> str:
    return " and ".join(names)


def _is_of_chip(script: LinkerScript, spec: BoardSpec) -> bool:
    return script.chip in ("", spec.chip.name)


def _memories(script: LinkerScript, spec: BoardSpec) -> BoardMemories:
    """Return the memories of an LDF: the board's, or none for another chip, whose memories bfsim does not know."""
    if _is_of_chip(script, spec):
        return BoardMemories(board=spec.name, regions=spec.chip.regions, bank_bytes=spec.sdram.bank_bytes)
    return BoardMemories(board=script.chip, regions=(), bank_bytes=spec.sdram.bank_bytes)


def _kinds(firmware: Firmware, size: FrameSize) -> dict[tuple[str | None, str], ContentKind]:
    """Return what each buffer is; everything else that the linker places is code."""
    return {
        (PROCESSORS[owner], each.name): _kind(each, firmware.camera)
        for owner, buffers in firmware.buffers(size).items()
        for each in buffers
    }


def _kind(buffer: Buffer, camera: str) -> ContentKind:
    if buffer.name == camera:
        return ContentKind.CAMERA
    if buffer.values is not None:
        return ContentKind.TABLE
    return ContentKind.LINES if buffer.rows > 1 else ContentKind.ROW
