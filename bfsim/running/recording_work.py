"""Record what the cores of a run do, for other runs to play."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path

from bfsim.errors import BfsimWarning, ConfigError
from bfsim.files.outputs import WORK, require_own
from bfsim.files.save import growing_file
from bfsim.loading.firmware import LoadedFirmware
from bfsim.machine.board import Board, Fidelity
from bfsim.machine.core.core import Core
from bfsim.machine.core.parts import Parts
from bfsim.recording.stereo.stereo_check import StereoCheck
from bfsim.running.digested_frames import DigestedFrames
from bfsim.running.playing_work import SAME, not_playable
from bfsim.trace import Identity


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
        warnings.warn(not_playable(path, obstacles), BfsimWarning, stacklevel=2)
