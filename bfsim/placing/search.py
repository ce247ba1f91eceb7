"""Measure, solve, write, run; and again with that run's measurements, as long as the model finds something better."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import Any

from bfsim.loading.firmware import load_firmware
from bfsim.loading.hardware import find_board, find_profile
from bfsim.machine.buffers import FrameSize
from bfsim.machine.symbols import require_cores, symbols_of
from bfsim.placing.ldf import LdfWriter
from bfsim.placing.measured import Measured, busy_of, frame_cclk
from bfsim.placing.model import Model
from bfsim.placing.placed import NEAR_CAMERA, Fill, Placed, PlacedPart, Trial
from bfsim.placing.reasons import about, accesses_of, cost_ms, reason
from bfsim.recording import RecordingReader
from bfsim.report.budget.times import milliseconds
from bfsim.running.building import build_for
from bfsim.running.inputs import calibration_of, read_placement
from bfsim.shipped import RECORDING
from bfsim.trace import RunRecord

ROUNDS = 4
"""The most placements that are run after the first."""
WORTH = 0.001
"""Another placement is run only if the model predicts that it saves more than this share of the frame."""
LEAST = 0.0001
"""A placement that saves less than this share is no better."""

BUSY_WEIGHT = 0.01
"""The weight of a cycle of the busiest core, where one of the frame is 1: if cameras bound it, less work is better."""

Places = tuple[int, ...]
Homes = tuple[int | None, ...]
"""The stretch of each part; parts of the original LDF may be in none."""


@dataclass(frozen=True, slots=True)
class _Try:
    """A placement that was run, and the frame's cycles that the model predicted."""

    places: Places
    predicted_cclk: float
    run: RunRecord


def place(
    recording: Path | None = None,
    *,
    firmware: str,
    board: str,
    settings: Mapping[str, object] = MappingProxyType({}),
    ldf: Path | None = None,
    defines: Mapping[str, str] = MappingProxyType({}),
    include_dirs: Sequence[Path] = (),
    profile: str,
    simulate: Callable[..., RunRecord],
    **how: Any,
) -> Placed:
    """Return the fastest placement found for `firmware` in the memories of an LDF; it has been run.

    The arguments are those of `bfsim.run.simulate`, which is `simulate` itself, or its substitute. Raises NoRoomError,
    with the items that lack room and how many bytes, if no placement fits, and any BfsimError of a run.
    """
    spec, compiler = find_board(board, settings).value, find_profile(profile).value
    loaded = load_firmware(firmware)
    require_cores(loaded.firmware, spec)
    script = read_placement(ldf, spec, defines, include_dirs)
    with RecordingReader(recording or RECORDING) as reader, loaded.own.named():
        size = FrameSize(reader.width, reader.height)
        symbols = symbols_of(
            loaded.firmware.calibrated(calibration_of(reader)), size, build_for(loaded, compiler)
        )
    model, measured = Model(spec, script, symbols), Measured()
    writer = LdfWriter(script, model.stretches)
    what = {"firmware": firmware, "board": board, "settings": settings, "profile": profile, **how}
    with TemporaryDirectory() as folder:

        def run(places: Places) -> RunRecord:
            path = Path(folder) / "placed.ldf"
            path.write_text(writer.text(model.parts, places, {}, ()), encoding="utf-8")
            return simulate(recording=recording, ldf=path, **what)

        moved_in = (
            None if model.is_linked else model.best(measured)
        )  # nothing has been measured: the fewest moves
        if moved_in:
            first = run(moved_in)
        else:
            first = simulate(recording=recording, ldf=ldf, defines=defines, include_dirs=include_dirs, **what)
        homes: Homes = moved_in or tuple(each.home for each in model.parts)
        measured.add(first, model.code_levels(homes))
        camera_cclk = float(spec.clocks.cclk_hz / spec.sensor.mode(size.width_px, size.height_px).frame_hz)
        tries = list(_tries(model, measured, first, homes, camera_cclk, run))
    return _placed(model, measured, first, moved_in, tries, writer, camera_cclk)


def _tries(
    model: Model,
    measured: Measured,
    first: RunRecord,
    homes: Homes,
    camera_cclk: float,
    run: Callable[[Places], RunRecord],
) -> Iterator[_Try]:
    """Run the best placement by the measurements so far, and yield it, as long as it is new and promising."""
    last, best_cclk, seen = first, math.inf, {homes}
    for _ in range(ROUNDS):
        places = model.best(measured)
        busy_cclk = max(model.busy_cclk(places, measured).values())
        saved = max(busy_of(last).values()) - busy_cclk
        predicted_cclk = max(frame_cclk(last) - saved, min(camera_cclk, frame_cclk(last)))
        if places in seen or predicted_cclk + BUSY_WEIGHT * busy_cclk > (1 - WORTH) * best_cclk:
            return
        seen.add(places)
        last = run(places)
        measured.add(last, model.code_levels(places))
        best_cclk = min(best_cclk, _score_cclk(last, camera_cclk))
        yield _Try(places, predicted_cclk, last)


def _score_cclk(run: RunRecord, camera_cclk: float) -> float:
    """Return the score of a placement, lower is better. Frames that the cameras bound are equally long."""
    frame = float(frame_cclk(run))
    bounded = camera_cclk if frame <= NEAR_CAMERA * camera_cclk else frame
    return bounded + BUSY_WEIGHT * max(busy_of(run).values())


def _placed(
    model: Model,
    measured: Measured,
    first: RunRecord,
    moved_in: Places | None,
    tries: Sequence[_Try],
    writer: LdfWriter,
    camera_cclk: float,
) -> Placed:
    """Return the records of the best placement that was run. `moved_in`: the first one if the LDF had no room."""
    hz = first.identity.cclk_hz
    enough = (1 - LEAST) * _score_cclk(first, camera_cclk)
    better = [each for each in tries if _score_cclk(each.run, camera_cclk) < enough]
    best = min(better, key=lambda each: _score_cclk(each.run, camera_cclk), default=None)
    after, places = (best.run, best.places) if best else (first, moved_in)
    homes: Homes = moved_in or tuple(each.home for each in model.parts)
    parts = tuple(_parts(model, measured, homes, places)) if places else ()
    found = Placed(
        identity=first.identity,
        start=model.script.path.name,
        linked=model.is_linked,
        frames=len(first.frames),
        before_ms=milliseconds(frame_cclk(first), hz),
        before_busy_ms=milliseconds(max(busy_of(first).values()), hz),
        camera_ms=milliseconds(camera_cclk, hz),
        trials=tuple(
            Trial(
                predicted_ms=milliseconds(each.predicted_cclk, hz),
                simulated_ms=milliseconds(frame_cclk(each.run), hz),
                busy_ms=milliseconds(max(busy_of(each.run).values()), hz),
            )
            for each in tries
        ),
        best=tries.index(best) if best else None,
        parts=parts,
        fills=tuple(_fills(first, after)) if places else (),
        ldf="",
    )
    if not places:
        return found
    why = {label: each.why for label, each in zip((part.label for part in model.parts), parts, strict=True)}
    return replace(found, ldf=writer.text(model.parts, places, why, about(found)))


def _parts(model: Model, measured: Measured, homes: Homes, places: Places) -> Iterator[PlacedPart]:
    for part, home, stretch in zip(model.parts, homes, places, strict=True):
        made = accesses_of(model, part, measured)
        after_ms = cost_ms(model, part, stretch, measured)
        before_ms = after_ms if home is None else cost_ms(model, part, home, measured)
        yield PlacedPart(
            name=part.symbol.name,
            core=part.owner,
            is_code=part.is_code,
            nbytes=part.symbol.nbytes,
            before=part.segment or ("" if home is None else model.stretches[home].segment.name),
            after=model.stretches[stretch].segment.name,
            reads=made.reads,
            writes=made.writes,
            streamed=part.name in measured.streamed,
            saved_ms=before_ms - after_ms,
            why=reason(model, part, stretch, measured),
        )


def _fills(before: RunRecord, after: RunRecord) -> Iterator[Fill]:
    used = {each.memory: each.used_bytes for each in before.memories}
    for each in after.memories:
        yield Fill(
            memory=each.memory,
            nbytes=each.nbytes,
            before_bytes=used.get(each.memory, 0),
            after_bytes=each.used_bytes,
        )
