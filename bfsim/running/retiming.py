"""Re-timing: record a run, or play a recorded one on other hardware."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from bfsim.errors import BfsimWarning, ConfigError, WorkError, shown
from bfsim.files.outputs import WORK, require_own
from bfsim.files.save import growing_file
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
def retimed(
    machine: Board,
    identity: Identity,
    frames: DigestedFrames,
    loaded: LoadedFirmware,
    check: StereoCheck,
    *,
    record_work: Path | None,
    work: Path | None,
    has_pictures: bool,
    has_timeline: bool,
) -> Iterator[None]:
    """In the `with` block, record the run of `machine` to a file, have it play one, or neither.

    `check` looks at the frames of a run; for a run that is played, it gets what was found then. `has_pictures`,
    `has_timeline`: whether anybody wants these.
    """
    with ExitStack() as stack:
        if record_work and work:
            raise ConfigError("--record-work must stand without --work: what is played is recorded already")
        if record_work and has_timeline:
            raise ConfigError(
                "--record-work must go without --trace and --html: these need every call, and a recording merges calls in L1; "
                "record in a run of its own"
            )
        if record_work:
            stack.enter_context(recording_work(record_work, machine, identity, frames, loaded, check))
        if work and (has_pictures or has_timeline):
            raise ConfigError(
                "--work must go without pictures, timelines and HTML: a recorded run has neither pixels nor single calls, only cycles"
            )
        if work:
            stack.enter_context(playing_work(work, machine, identity, frames, loaded, check))
        yield


class _InterruptedError(Exception):
    """Raised to leave no file of an incomplete run, which cannot be played, in place of a complete one."""


@contextmanager
def recording_work(
    path: Path,
    machine: Board,
    identity: Identity,
    frames: DigestedFrames,
    loaded: LoadedFirmware,
    check: StereoCheck,
) -> Iterator[None]:
    """In the `with` block, record what the cores of `machine` do; an interrupted run leaves no file.

    Raises ConfigError if it cannot be written.
    """
    from bfsim.machine.retiming.recorded_ahead import RecordedAhead  # few runs are recorded
    from bfsim.machine.retiming.recording_core import RecordingCore
    from bfsim.running.work_file import WorkWriter

    if machine.fidelity is not Fidelity.FAST:
        raise ConfigError(
            "--record-work must go with --fidelity fast: only there the same buses play it again"
        )
    require_own(path, WORK)
    obstacles: Sequence[str] = ()
    with suppress(_InterruptedError), growing_file(path) as stream, WorkWriter(stream, path) as writer:
        cores: list[RecordingCore] = []

        def recorded(parts: Parts) -> Core:
            cores.append(RecordingCore(parts, on_work=writer.add, on_obstacle=writer.add_obstacle))
            return cores[-1]

        machine.core, machine.ahead = recorded, RecordedAhead
        writer.begin(
            identity={
                each: value for each, value in asdict(identity).items() if each in (*SAME, "ldf_digest")
            },
            buffers=machine.owners_of_memory,
            is_bound=machine.is_bound_to_placement,
            routines_outside=machine.routines_outside,
        )
        yield
        for core in cores:
            core.end()
        if not all(each.is_done for each in machine.main_loops.values()):
            raise _InterruptedError
        writer.end(
            frames=frames.known,
            modules=sorted(loaded.own.modules),
            firmware_digest=loaded.digest,
            doubts=check.counts,
        )
        obstacles = writer.obstacles
    if obstacles:
        warnings.warn(_not_playable(path, obstacles), BfsimWarning, stacklevel=2)


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
        raise WorkError(_not_playable(path, recorded.obstacles))


def _not_playable(path: Path, obstacles: Sequence[str]) -> str:
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
