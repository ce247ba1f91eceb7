"""What a user must not overlook in a run: assumptions, missed frames, losses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from bfsim.trace import RunRecord, RunWarning, WarningKind

MISSED_LISTED = 10
"""Missed frames that are listed by number."""

MACHINE_LOSSES = {"ppi_words_lost": "words of the camera that the DMA was too late for"}
"""Losses that the simulated machine publishes, as `RunRecord.losses` for those of the firmware."""


def warnings_of(run: RunRecord) -> tuple[RunWarning, ...]:
    """Return the warnings about a run of at least one frame, those about the whole run first."""
    return (*run.assumptions, *_missed(run), *_devices(run), *_lost(run))


def _devices(run: RunRecord) -> Iterator[RunWarning]:
    for peripheral, notes in run.device_notes.items():
        yield from (RunWarning(kind=f"{peripheral} device", text=each) for each in notes)


def _missed(run: RunRecord) -> Iterator[RunWarning]:
    missed, frames = len(run.missed), len(run.missed) + len(run.frames)
    if missed:
        yield RunWarning(
            kind=WarningKind.MISSED,
            text=f"{missed:,} of {frames:,} frames came while the firmware was busy, and were missed: {_listed(run.missed)}",
            numbers={"missed": missed, "frames": frames},
        )


def missed_frames(run: RunRecord) -> str:
    """Return how many frames were missed, and which."""
    return f"{len(run.missed)} ({_listed(run.missed)})" if run.missed else "0"


def _listed(frames: Sequence[int]) -> str:
    more = ", …" if len(frames) > MISSED_LISTED else ""
    return ", ".join(map(str, frames[:MISSED_LISTED])) + more


def _lost(run: RunRecord) -> Iterator[RunWarning]:
    """Yield what was lost. Cores with identical losses share a warning: both see a recording of one camera."""
    for name, what in (*MACHINE_LOSSES.items(), *run.losses.items()):
        alike: dict[tuple[tuple[tuple[int, int], ...], str], list[str]] = {}
        for core in run.frames[0].cores:
            counts = ((frame.results.get(f"{name}_{core.core}", 0), frame.index) for frame in run.frames)
            lost = tuple(each for each in counts if each[0])
            if lost:
                rows = _rows(run, f"{name}_{{}}_{core.core}", _worst(lost)[1])
                alike.setdefault((lost, rows), []).append(core.core)
        for (lost, rows), cores in alike.items():
            total, (worst, at) = sum(count for count, _ in lost), _worst(lost)
            where = f"core {cores[0]}" if len(cores) == 1 else f"each of cores {' and '.join(cores)}"
            yield RunWarning(
                kind=WarningKind.LOST,
                text=f"{what}: {total:,} on {where}, in {len(lost):,} of {len(run.frames):,} frames; "
                f"most in frame {at}: {worst:,}{rows}",
                numbers={"total": total, "frames": len(lost), "worst": worst, "worst_frame": at},
                results=tuple(f"{name}_{core}" for core in cores),
            )


def _worst(lost: Sequence[tuple[int, int]]) -> tuple[int, int]:
    """Return the greatest of (count, frame), the first of equal ones."""
    return max(lost, key=lambda each: (each[0], -each[1]))


def _rows(run: RunRecord, name: str, index: int) -> str:
    """Return the rows in which a frame lost most, and which part, if published as `name` of top, bottom and percent."""
    results = next(each.results for each in run.frames if each.index == index)
    top, bottom, percent = (results.get(name.format(each)) for each in ("top", "bottom", "percent"))
    if top is None or bottom is None or percent is None:
        return ""
    return f", {percent} % of those in rows {top} to {bottom}"
