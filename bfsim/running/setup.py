"""The parts of a run before its first frame: what was found by the given names, fitted to a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from bfsim.chip.spec import BoardSpec
from bfsim.kernel import CompilerProfile
from bfsim.kernel.build import Build
from bfsim.linker import LinkerScript, LinkMap
from bfsim.loading.firmware import LoadedFirmware
from bfsim.loading.hardware import Found
from bfsim.machine.board import Fidelity
from bfsim.machine.buffers import FrameSize
from bfsim.machine.cameras.capture import Feed
from bfsim.machine.peripherals.device import Device
from bfsim.machine.program import Calibration, Firmware
from bfsim.process.once import remembering_here
from bfsim.recording import RecordingReader
from bfsim.running.building import build_for
from bfsim.running.inputs import calibration_of
from bfsim.running.room import place


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSetup:
    """What runs, and on what, whatever the recording.

    `devices` stand under the names of their peripherals; `script_digest` is that of their script, "" without one.
    `defines`: macros that the LDF was read with.
    """

    board: Found[BoardSpec]
    compiler: Found[CompilerProfile]
    loaded: LoadedFirmware
    placement: LinkerScript
    defines: Mapping[str, str]
    devices: dict[str, Device]
    script_digest: str
    feed: Feed
    fidelity: Fidelity


@dataclass(frozen=True, slots=True)
class FittedFirmware:
    """Firmware fitted to the cameras and pictures of a recording, how its kernels are built, and where it lies."""

    firmware: Firmware
    calibration: Calibration
    size: FrameSize
    build: Build
    link_map: LinkMap


def fit(setup: RunSetup, reader: RecordingReader) -> FittedFirmware:
    """Return the firmware of a run, fitted to a recording. Raises a BfsimError if it cannot be built, or does not fit."""
    plain, calibration = setup.loaded.firmware, calibration_of(reader)
    size = FrameSize(reader.width, reader.height)
    with remembering_here():  # several steps ask for the kernels
        firmware, build = plain.calibrated(calibration), build_for(setup.loaded, setup.compiler.value)
        link_map = place(plain, calibration, size, setup.placement, setup.board.value, build)
    return FittedFirmware(firmware, calibration, size, build, link_map)
