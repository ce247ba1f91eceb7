"""Play a recorded run in place of the firmware, on hardware on which it can be played."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from bfsim.errors import ConfigError, WorkError, shown
from bfsim.kernel import Kernel
from bfsim.loading.firmware import LoadedFirmware
from bfsim.loading.kernels import kernels_of
from bfsim.loading.modules import import_more
from bfsim.machine.board import Board, Fidelity
from bfsim.machine.core.core import Core
from bfsim.machine.core.parts import Parts
from bfsim.machine.named_kernels import kernels_named
from bfsim.recording.stereo.stereo_check import StereoCheck
from bfsim.running.digested_frames import DigestedFrames
from bfsim.trace import DIGITS_SHOWN, Identity

if TYPE_CHECKING:
    from bfsim.running.work_file import WorkReader

SAME = {
    "recording": "recording",
    "firmware": "firmware",
    "compiler": "compiler",
    "compiler_digest": "compiler",
    "code_digest": "code of its kernels",
    "file_compiler": "compiler of kernels in C",
    "script_digest": "script for the device",
    "llvm_version": "version of LLVM",
}
"""Fields of an identity that a recorded run must share with the run that plays it, in words."""
SAID_BY = {"recording": "a RECORDING before the options", "firmware": "--firmware", "compiler": "--profile"}
"""How to give the same as in the recorded run, which is not taken from its file."""


@contextmanager
def playing_work(
    path: Path,
    machine: Board,
    identity: Identity,
    frames: DigestedFrames,
    loaded: LoadedFirmware,
    check: StereoCheck,
) -> Iterator[None]:
    """In the `with` block, have the cores of `machine` play a recorded run in place of the firmware.

    Raises WorkError for a file that is not a complete recorded run, is one of another recording, firmware or compiler,
    or cannot be played on this machine.
    """
    from bfsim.machine.retiming.replayed_core import played_again
    from bfsim.running.work_file import opened

    with opened(path) as reader:
        _check(reader, machine, identity, frames.total)
        kernels = _kernels(reader, loaded)
        frames.expect(reader.recorded.frames)
        check.take_counts(reader.recorded.doubts)
        machine.firmware = replace(
            machine.firmware, mains=dict.fromkeys(machine.firmware.mains, played_again), view=None
        )
        machine.core, machine.ahead = partial(_replayed, reader, kernels), None
        yield


def _replayed(reader: WorkReader, kernels: dict[str, Kernel], parts: Parts) -> Core:
    from bfsim.machine.retiming.replayed_core import ReplayedCore

    return ReplayedCore(parts, kernels, reader.works(parts.name))


def _check(reader: WorkReader, machine: Board, identity: Identity, total: int) -> None:
    path, recorded = reader.path, reader.recorded
    if machine.fidelity is not Fidelity.FAST:
        raise ConfigError("--work must go with --fidelity fast: only there the same buses play it again")
    for field, what in SAME.items():
        now, then = getattr(identity, field), recorded.identity.get(field)
        if now != then:
            if field.endswith("digest"):
                now, then = (str(each)[:DIGITS_SHOWN] for each in (now, then))
            again = f"give it again by {SAID_BY[field]}, or " if field in SAID_BY else ""
            raise WorkError(
                f"{path} must be recorded with the same {what}, {shown(now)}, not with {shown(then)}: {again}record it again"
            )
    if total != len(recorded.frames.digests):
        raise WorkError(
            f"{path} must be played for as many frames as it has, {len(recorded.frames.digests)}, not for {total}: see --frames"
        )
    if [*recorded.buffers] != [*map(tuple, machine.owners_of_memory)]:
        raise WorkError(f"{path} must be recorded with the same buffers: record it again")
    is_bound = recorded.is_bound or machine.is_bound_to_placement
    if is_bound and recorded.identity.get("ldf_digest") != identity.ldf_digest:
        raise WorkError(
            f"{path} must be played with the LDF that it was recorded with, because one of the two has caches or a stack outside L1, "
            "whose traffic depends on where everything lies; record it with this LDF"
        )
    there, here = (
        {tuple(pair) for pair in each} for each in (recorded.routines_outside, machine.routines_outside)
    )
    if there != here:
        core, routine = min(there ^ here)
        raise WorkError(
            f"{path} must be played with the same code outside L1, whose fetches are recorded, but {routine} of core {core} lies there "
            f"only {'in the recorded run' if (core, routine) in there else 'now'}; record it with this LDF"
        )
    if recorded.obstacles:
        raise WorkError(not_playable(path, recorded.obstacles))


def not_playable(path: Path, obstacles: Sequence[str]) -> str:
    """Say why a recorded run cannot be played, with the first of its obstacles."""
    first, more = obstacles[0], len(obstacles) - 1
    others = f", and {more} more like it" if more else ""
    return f"{path} cannot be played on other hardware, for what the cores do depends on it: {first}{others}; run the firmware itself there"


def _kernels(reader: WorkReader, loaded: LoadedFirmware) -> dict[str, Kernel]:
    """Return the kernels of the firmware by symbol. Raises WorkError if its sources differ from the recorded ones."""
    for name in reader.recorded.modules:
        if name not in loaded.own.modules and loaded.own.has(name):  # imported while the firmware runs
            import_more(name, loaded.own)
    if loaded.digest != reader.recorded.firmware_digest:
        raise WorkError(
            f"{reader.path} must be recorded with the firmware as it is now, and its sources have changed: record it again"
        )
    named = (kernel for main in loaded.firmware.mains.values() for kernel in kernels_named(main))
    return {each.function.symbol: each for each in (*named, *kernels_of(loaded.own))}
