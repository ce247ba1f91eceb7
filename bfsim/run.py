"""One run: recording + firmware + board + LDF → the records of what every frame cost."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import fields, replace
from functools import partial, wraps
from inspect import signature
from itertools import count
from pathlib import Path
from threading import RLock
from types import MappingProxyType
from typing import ParamSpec

from bfsim import shipped
from bfsim.chip.spec import BoardSpec
from bfsim.errors import ConfigError, RecordingError
from bfsim.kernel.profile import DEFAULT
from bfsim.linker import LinkMap
from bfsim.loading.firmware import load_firmware
from bfsim.loading.given import given_firmware
from bfsim.loading.hardware import find_board, find_profile
from bfsim.machine.board import Board, Fidelity
from bfsim.machine.calls.watched_call import BeforeCall, Sanitizer
from bfsim.machine.cameras.capture import Feed
from bfsim.machine.named_kernels import kernels_named
from bfsim.machine.program import Firmware
from bfsim.machine.symbols import require_cores
from bfsim.process.streams import streams_kept
from bfsim.recording import RecordingReader
from bfsim.recording.stereo.stereo_check import StereoCheck
from bfsim.result import Run
from bfsim.running.arguments import one_of, path_of, require_kinds
from bfsim.running.assumptions import (
    assumed_clocks,
    assumed_geometry,
    assumed_tables,
    doubted_cameras,
    geometry_in_words,
)
from bfsim.running.compiled_ahead import compiled_ahead
from bfsim.running.devices import told_devices
from bfsim.running.digested_frames import DigestedFrames
from bfsim.running.identifying import identity_of, written
from bfsim.running.inputs import opened, read_placement
from bfsim.running.retiming import retimed
from bfsim.running.room import outside_l1
from bfsim.running.setup import FittedFirmware, RunSetup, fit
from bfsim.seen import Seen, SeenFrame
from bfsim.spans import Span
from bfsim.trace import BoardRecord, Identity, MemoryRecord, RunWarning

_WATCHING = ("before", "progress", "on_seen", "on_time", "on_spans", "on_call", "record_work", "work")
"""Arguments of `simulate` that change nothing in the records; a repeated run has others."""

Given = ParamSpec("Given")


_ONE_AT_A_TIME = RLock()
"""Held by the running thread: variables of kernels and names of firmware modules can serve only one run at a time."""


def _let_runs_begin() -> None:
    """Let runs begin in a forked process: it has none of its parent's other threads."""
    global _ONE_AT_A_TIME  # noqa: PLW0603  # a run that the thread has forked in gives back the lock that it took
    _ONE_AT_A_TIME = RLock()


os.register_at_fork(after_in_child=_let_runs_begin)


def _repeatable(simulate: Callable[Given, Run]) -> Callable[Given, Run]:
    """Return `simulate`, but with the function that repeats the run in the run it returns."""

    @wraps(simulate)
    def repeatable(*arguments: Given.args, **options: Given.kwargs) -> Run:
        __tracebackhide__ = True  # a test that calls it with a wrong argument shows its own lines
        try:
            bound = signature(simulate).bind(*arguments, **options)
        except TypeError as error:  # it names no function
            raise TypeError(f"simulate() {error}") from None
        bound.apply_defaults()
        require_kinds(bound.arguments)
        with _ONE_AT_A_TIME, streams_kept():
            done = simulate(*arguments, **options)
        what = {
            name: dict(value) if isinstance(value, Mapping) else value
            for name, value in bound.arguments.items()
            if name not in _WATCHING
        }
        return replace(done, again=partial(by_name, **what))

    by_name: Callable[..., Run] = repeatable
    return repeatable


@_repeatable
def simulate(
    recording: Path | str | None = None,
    *,
    firmware: Firmware | str = shipped.FIRMWARE[0],
    board: str | BoardSpec = "cm-bf561",
    settings: Mapping[str, object] = MappingProxyType({}),
    ldf: Path | str | None = None,
    defines: Mapping[str, str] = MappingProxyType({}),
    include_dirs: Sequence[Path | str] = (),
    frames: int | None = None,
    feed: Feed | str = Feed.DEMAND,
    fidelity: Fidelity | str = Fidelity.FAST,
    sanitize: bool = False,
    profile: str = DEFAULT.name,
    script: Path | str | None = None,
    record_work: Path | str | None = None,
    work: Path | str | None = None,
    before: Callable[[Identity, int], None] | None = None,
    progress: Callable[[int, int], None] | None = None,
    on_seen: Callable[[SeenFrame], None] | None = None,
    on_time: Callable[[float], None] | None = None,
    on_spans: Callable[[Sequence[Span]], None] | None = None,
    on_call: BeforeCall | None = None,
) -> Run:
    """Run `firmware` on a recording and return the records of what every frame cost.

    What runs, and on what:

    - `recording`: a file; by default the built-in one. `frames` stops early.
    - `firmware`: a `Firmware`, or a name: of a built-in one, "FILE.py:NAME" or "PACKAGE:NAME". The identity of a `Firmware`
      covers its source files as they are now, but not values set elsewhere, such as at a prompt.
    - `board`: the name of a shipped one, "FILE.py:NAME", "PACKAGE:NAME" or a BoardSpec. `settings` changes numbers in it by
      their paths, such as {"sdram.nRP": 3}; see `bfsim.chip.settings`.
    - `profile`: the compiler whose code is costed, named in the same ways.
    - `ldf`: a file or the name of a shipped one; by default the board's. `defines` are macros for it, and `include_dirs` the
      folders that it may include files from.
    - `feed`: when pictures come. `fidelity`: how the buses are simulated.
    - `script`: a JSON or TOML file for the firmware's devices.
    - `record_work`: a file in which to record the work of the cores. `work`: such a file, played instead of running the
      firmware: the same records on another board or LDF, faster.
    - `sanitize` first runs each kernel as it is written, to find errors even in code that the compiler removes. Kernels that
      run as newly compiled code do so in the first frame anyway. Estimated kernels are always checked.

    Functions that are called during the run; they change nothing in the records:

    - `before`, with what will run and how many frames of it, before the first one. It may raise. The digest of the recording
      is not known then.
    - `progress`, with (frames done, frames in all).
    - `on_seen`, with what was seen in each frame, if the firmware has a view.
    - `on_time`, now and then, with the simulated time in seconds.
    - `on_spans`, with what the cores and devices did since the last time.
    - `on_call`, with each kernel and its arguments before it runs.

    Raises a BfsimError for any mistake in the arguments. Ctrl-C ends the run with the frames done. Runs of several threads
    come one after the other: use processes, as `bfsim sweep` does. A crash in native code ends the process, even a
    notebook's; standard error then has the name of the kernel.
    """
    if frames is not None and frames < 1:
        raise ConfigError(f"frames must be at least 1, not {frames}")
    feed, fidelity = one_of(Feed, "feed", feed), one_of(Fidelity, "fidelity", fidelity)
    recording, script, record_work, work = (
        path_of(what, given)
        for what, given in {
            "recording": recording, "script": script, "record_work": record_work, "work": work,
        }.items()
    )  # fmt: skip
    found_board, found_compiler = find_board(board, settings), find_profile(profile)
    loaded = given_firmware(firmware) if isinstance(firmware, Firmware) else load_firmware(firmware)
    require_cores(loaded.firmware, found_board.value)
    with loaded.own.named():
        devices, script_digest = told_devices(script, loaded)
    setup = RunSetup(
        board=found_board,
        compiler=found_compiler,
        loaded=loaded,
        placement=read_placement(ldf, found_board.value, defines, include_dirs),
        defines=defines,
        devices=devices,
        script_digest=script_digest,
        feed=feed,
        fidelity=fidelity,
    )
    with loaded.own.named(), opened(recording or shipped.RECORDING) as reader:
        fitted = fit(setup, reader)
        machine = _machine(setup, fitted, sanitize=sanitize, on_call=on_call)
        source = DigestedFrames(reader, _frames_to_run(reader, frames))
        check = StereoCheck(reader.rectification)
        identity = identity_of(setup, fitted, source.name)
        if before:
            before(identity, source.total)
        wants = {"has_pictures": bool(on_seen), "has_timeline": bool(on_spans)}
        outside = outside_l1(fitted.link_map, setup.board.value.chip.regions)
        ahead = nullcontext() if work else compiled_ahead(fitted.firmware, fitted.build, outside)
        with (
            ahead,
            retimed(machine, identity, source, loaded, check, record_work=record_work, work=work, **wants),
        ):
            told = _told_of_frames(progress, source.total) if progress else None
            show = _shown_to(on_seen, source) if on_seen else None
            left = machine.run(check.watch(source), told, show, on_time, on_spans)
    identity = replace(
        identity,
        recording_digest=source.digest,
        firmware_digest=loaded.digest,  # it may have imported more
        firmware_files=loaded.files,
    )
    return _record(left, identity, setup, fitted, doubted_cameras(check.warnings))


def _machine(setup: RunSetup, fitted: FittedFirmware, *, sanitize: bool, on_call: BeforeCall | None) -> Board:
    """Return the board with the firmware in it.

    Newly compiled code is sanitized for a frame, and all code always if `sanitize`; then `on_call` is called.
    """
    sanitizer = (Sanitizer(),)
    return Board(
        setup.board.value,
        fitted.firmware,
        fitted.size,
        fitted.link_map,
        feed=setup.feed,
        before_call=(*(sanitizer if sanitize else ()), *((on_call,) if on_call else ())),
        in_first_frame=() if sanitize or fitted.build.is_tried else sanitizer,
        build=fitted.build,
        devices=setup.devices,
        fidelity=setup.fidelity,
    )


def _told_of_frames(progress: Callable[[int, int], None], total: int) -> Callable[[object], None]:
    """Return a listener for finished frames, which tells `progress` how many of `total` are done."""
    done = count(1)
    return lambda _frame: progress(next(done), total)


def _frames_to_run(reader: RecordingReader, most: int | None) -> int:
    """Return how many frames of a recording to run. Raises RecordingError if it has none."""
    if not reader.frame_count:
        raise RecordingError(f"{reader.path}: a recording must have at least one stereo frame, not none")
    return min(most or reader.frame_count, reader.frame_count)


def _shown_to(
    on_seen: Callable[[SeenFrame], None], source: DigestedFrames
) -> Callable[[int, tuple[Seen, ...]], None]:
    """Return a listener for what was seen in a frame, which passes it on with the times of the pictures."""
    return lambda index, cameras: on_seen(
        SeenFrame(index=index, times_ns=source.times_ns(index), cameras=cameras)
    )


def _memories(link_map: LinkMap, spec: BoardSpec) -> Iterator[MemoryRecord]:
    for region in spec.chip.regions:
        segments = [each for each in link_map.segments if region.holds(each.start, 1)]
        if segments:
            used_bytes = sum(each.used_bytes for each in segments)
            yield MemoryRecord(memory=region.name, nbytes=region.nbytes, used_bytes=used_bytes)


def _record(
    left: BoardRecord,
    identity: Identity,
    setup: RunSetup,
    fitted: FittedFirmware,
    doubts: Iterable[RunWarning],
) -> Run:
    """Return the records of a run. `doubts` are about its cameras, from their pictures."""
    firmware, calibration, spec = setup.loaded.firmware, fitted.calibration, setup.board.value
    ldf = setup.placement.path
    return Run(
        **{each.name: getattr(left, each.name) for each in fields(left)},
        identity=identity,
        firmware_place="built in" if setup.loaded.is_built_in else written(setup.loaded.path),
        ldf_place="shipped" if ldf.parent == shipped.LDF_FOLDER else written(ldf.absolute()),
        rows=firmware.rows,
        reference=firmware.reference,
        geometry=geometry_in_words(fitted.firmware, calibration),
        assumptions=(
            *assumed_geometry(fitted.firmware, calibration),
            *doubts,
            *assumed_clocks(spec),
            *assumed_tables(
                {core: kernels_named(main) for core, main in fitted.firmware.mains.items()},
                spec,
                fitted.link_map,
            ),
        ),
        losses=firmware.losses,
        memories=tuple(_memories(fitted.link_map, spec)),
    )


__all__ = ["Feed", "Fidelity", "simulate"]
