"""A timeline for https://ui.perfetto.dev: Perfetto's own protobuf, written span by span while the run goes on.

Times in the file are ns, rounded down. A CCLK cycle is longer than a ns, so each ns belongs to one cycle, and
`cycle_of` returns the exact cycle.

A call has its issue cycles and interlocks as arguments. Its waits for memories are slices within its own, at its end:
where in the call they occurred is not known.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import IO

from perfetto.protos.perfetto.trace import perfetto_trace_pb2 as proto

from bfsim.report.viewers.perfetto_track import NS, Track, framed
from bfsim.spans import Span, SpanKind
from bfsim.trace import StallReason

_LEVEL = 1  # of zlib: fast
_CALLED, _MOVED = ("issue_cclk", "interlocks_cclk"), ("bytes",)
"""Names of a slice's arguments."""
_ENDED = "ended"
"""The mark at the end of a wait."""
_TOGETHER = 1 << 14
"""The number of packets that are compressed together."""
_TOP = "board"
"""The track above all others."""
_ORDER = ("core", "SDRAM", "L2", "MDMA", "IMDMA", "PPI", "semaphore", "lock")
"""Devices from top to bottom, by the beginnings of their names; the peripherals follow."""
_TRACKS = ("frames", "stages", "work", "interrupts")
"""Tracks of a core from top to bottom; the others follow by name."""


def cycle_of(ns: int, cclk_hz: Fraction) -> int:
    """Return the cycle for which `ns_of` returned `ns`, at up to 1 GHz."""
    return -(-ns * cclk_hz.numerator // (NS * cclk_hz.denominator))


class PerfettoTrace:
    """Writes the timeline of one run to a stream. `cclk_hz`: the cores' clock, at most 1 GHz."""

    def __init__(self, stream: IO[bytes], cclk_hz: float) -> None:
        self._stream = stream
        self._cclk_hz = Fraction(cclk_hz)
        self._uuids: dict[tuple[str, ...], int] = {}
        self._tracks: dict[tuple[str, str], Track] = {}
        self._of_kind: dict[tuple[SpanKind, str, str], Track] = {}  # faster than by name
        self._packets: list[bytes] = []

    def add(self, spans: Sequence[Span]) -> None:
        """Write spans, which come in order of time on each track; call `flush` after the last ones."""
        for span in spans:
            kind = span.kind
            key = kind, span.where, span.name if kind is SpanKind.LEVEL else ""
            track = self._of_kind.get(key)
            if track is None:
                track = self._of_kind[key] = self._tracks.get(span.track) or self._open(span)
            _WRITE[kind](track, span)
        if len(self._packets) >= _TOGETHER:
            self.flush()

    def flush(self) -> None:
        """Write the packets that are held back for compression."""
        if self._packets:
            compressed = zlib.compress(b"".join(self._packets), _LEVEL)
            self._packets.clear()
            self._stream.write(framed(proto.TracePacket(compressed_packets=compressed)))

    def _open(self, span: Span) -> Track:
        """Describe the track of a span, and its device if it is new."""
        where, name = span.track
        if not self._uuids:
            self._describe((), 0, _TOP, 0)  # Perfetto's page keeps an order below a track, not at the top
        if (where,) not in self._uuids:
            self._describe((where,), self._uuids[()], where, _rank(where, _ORDER))
        uuid = self._describe(
            span.track,
            self._uuids[where,],
            name,
            _rank(name, _TRACKS),
            is_counter=span.kind is SpanKind.LEVEL,
        )
        track = self._tracks[span.track] = Track(uuid, self._cclk_hz, self._packets.append)
        return track

    def _describe(
        self, key: tuple[str, ...], parent: int, name: str, rank: int, *, is_counter: bool = False
    ) -> int:
        """Describe a track or a device; return its number."""
        uuid = self._uuids[key] = len(self._uuids) + 1
        track = proto.TrackDescriptor(
            uuid=uuid,
            parent_uuid=parent,
            name=name,
            sibling_order_rank=rank,
            child_ordering=proto.TrackDescriptor.EXPLICIT,
        )
        if is_counter:
            track.counter.SetInParent()
        self._packets.append(framed(proto.TracePacket(track_descriptor=track)))
        return uuid


def _slice(track: Track, span: Span) -> None:
    track.begin(span.begin_cclk, span.name)
    track.end(span.end_cclk)


def _wait(track: Track, span: Span) -> None:
    """Write a wait, with a mark at its end: an arrow leads forward in time, and a wait may begin before its transfer."""
    track.begin(span.begin_cclk, span.name, span.flow)
    if span.flow:
        track.mark(span.end_cclk, _ENDED, span.flow)
    track.end(span.end_cclk)


def _moving(track: Track, span: Span) -> None:
    track.begin(span.begin_cclk, span.name, span.flow, _MOVED, (span.value,))
    track.end(span.end_cclk)


def _call(track: Track, span: Span) -> None:
    """Write a call, and its waits for memories as slices at its end."""
    interlocks_cclk = span.stall_cclk.get(StallReason.INTERLOCK, 0)
    track.begin(span.begin_cclk, span.name, 0, _CALLED, (span.issue_cclk, interlocks_cclk))
    at_cclk = span.begin_cclk + span.issue_cclk + interlocks_cclk
    if at_cclk < span.end_cclk:
        for reason, cclk in span.stall_cclk.items():
            if reason is not StallReason.INTERLOCK:
                track.begin(at_cclk, reason.value)
                at_cclk += cclk
                track.end(at_cclk)
    track.end(span.end_cclk)


def _level(track: Track, span: Span) -> None:
    track.count(span.begin_cclk, span.value)


_WRITE: dict[SpanKind, Callable[[Track, Span], None]] = {
    **dict.fromkeys(SpanKind, _slice),
    SpanKind.CALL: _call,
    SpanKind.STALL: _wait,
    SpanKind.IDLE: _wait,
    SpanKind.TRANSFER: _moving,
    SpanKind.MESSAGE: _moving,
    SpanKind.LEVEL: _level,
}


def _rank(name: str, order: Sequence[str]) -> int:
    """Return the position of a track among its siblings, by the beginning of its name."""
    return next((number for number, each in enumerate(order) if name.startswith(each)), len(order))
