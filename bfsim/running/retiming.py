"""Re-timing: record a run, or play a recorded one on other hardware."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from bfsim.errors import ConfigError
from bfsim.loading.firmware import LoadedFirmware
from bfsim.machine.board import Board
from bfsim.recording.stereo.stereo_check import StereoCheck
from bfsim.running.digested_frames import DigestedFrames
from bfsim.running.playing_work import playing_work
from bfsim.running.recording_work import recording_work
from bfsim.trace import Identity


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
