"""A timeline as a file that https://ui.perfetto.dev opens: Perfetto's own protobuf, written span by span as the run goes on.

Times in the file are ns, rounded down. A CCLK cycle is longer than a ns, so that each ns is of one cycle only, and `cycle_of`
has the cycles back, exactly.

Every track is a packet sequence of its own: its clock counts ns from the packet before, its names are told once, and what all
packets of it share is a default. Some thousand packets are compressed together.

A call has its issue cycles and interlocks as arguments. Its waits for memories are slices within its own, at its end: where in
the call they were is not known.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import IO, Any

from perfetto.protos.perfetto.trace import perfetto_trace_pb2 as proto

from bfsim.spans import Span, SpanKind
from bfsim.trace import StallReason

_CLOCK, _BOOTTIME = 64, proto.BUILTIN_CLOCK_BOOTTIME
_LEVEL = 1  # of zlib: fast
_CALLED, _MOVED = ("issue_cclk", "interlocks_cclk"), ("bytes",)
"""Names of what a slice says besides its time."""
_ENDED = "ended"
"""The mark at the end of a wait."""
_TOGETHER = 1 << 14
"""Packets that are compressed together."""
_MOST_KNOWN = 1 << 14
"""Packets that are kept for each track."""
_NS = 1_000_000_000
_TOP = "board"
"""The track that all others lie below."""
_ORDER = ("core", "SDRAM", "L2", "MDMA", "IMDMA", "PPI", "semaphore", "lock")
"""Devices from top to bottom, by how their names begin; the peripherals follow."""
_TRACKS = ("frames", "stages", "work", "interrupts")
"""Tracks of a core from top to bottom; the others follow by name."""


def ns_of(cclk: int, cclk_hz: Fraction) -> int:
    """Return the last whole ns at or before a cycle."""
    return cclk * _NS * cclk_hz.denominator // cclk_hz.numerator


def cycle_of(ns: int, cclk_hz: Fraction) -> int:
    """Return the cycle that `ns_of` gave `ns` for, at up to 1 GHz."""
    return -(-ns * cclk_hz.numerator // (_NS * cclk_hz.denominator))


class PerfettoTrace:
    """Writes the timeline of one run to a stream. `cclk_hz`: the cores' clock, at most 1 GHz."""

    def __init__(self, stream: IO[bytes], cclk_hz: float) -> None:
        self._stream = stream
        self._cclk_hz = Fraction(cclk_hz)
        self._uuids: dict[tuple[str, ...], int] = {}
        self._tracks: dict[tuple[str, str], _Track] = {}
        self._of_kind: dict[tuple[SpanKind, str, str], _Track] = {}  # found faster than by its name
        self._packets: list[bytes] = []

    def add(self, spans: Sequence[Span]) -> None:
        """Write spans, which come in the order of time on each track; `flush` behind the last ones."""
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
        """Write what is held back to be compressed together."""
        if self._packets:
            compressed = zlib.compress(b"".join(self._packets), _LEVEL)
            self._packets.clear()
            self._stream.write(_framed(proto.TracePacket(compressed_packets=compressed)))

    def _open(self, span: Span) -> _Track:
        """Describe the track of a span, and the device that it belongs to where that is new."""
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
        track = self._tracks[span.track] = _Track(uuid, self._cclk_hz, self._packets.append)
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
        self._packets.append(_framed(proto.TracePacket(track_descriptor=track)))
        return uuid


class _Track:
    """One track, as a sequence of packets.

    Packets that differ in their time only are put together once: the time is appended, as fields may come in any order.
    """

    def __init__(self, uuid: int, cclk_hz: Fraction, write: Callable[[bytes], None]) -> None:
        self._uuid = uuid
        self._write = write
        self._ns_of = _NS * cclk_hz.denominator, cclk_hz.numerator
        self._ns = 0
        self._iids: dict[tuple[str, str], int] = {}
        self._beginnings: dict[tuple[str, tuple[str, ...]], Any] = {}
        self._known: dict[tuple[object, ...], bytes] = {}
        self._end = self._packet(type=proto.TrackEvent.TYPE_SLICE_END).SerializeToString()
        clocks = [
            proto.ClockSnapshot.Clock(clock_id=_CLOCK, timestamp=0, is_incremental=True),
            proto.ClockSnapshot.Clock(clock_id=_BOOTTIME, timestamp=0),
        ]
        first = proto.TracePacket(
            trusted_packet_sequence_id=uuid,
            sequence_flags=proto.TracePacket.SEQ_INCREMENTAL_STATE_CLEARED,
            clock_snapshot=proto.ClockSnapshot(clocks=clocks),
        )
        first.trace_packet_defaults.timestamp_clock_id = _CLOCK
        first.trace_packet_defaults.track_event_defaults.track_uuid = uuid
        write(_framed(first))

    def begin(
        self,
        cclk: int,
        name: str,
        flow: int = 0,
        arguments: tuple[str, ...] = (),
        values: tuple[int, ...] = (),
    ) -> None:
        """Begin a slice at a cycle. `flow`: a number that it shares with another slice, or 0; only few have one."""
        key = name, values
        octets = None if flow else self._known.get(key)
        if octets is None:
            packet = self._beginning(name, arguments)
            for annotation, value in zip(packet.track_event.debug_annotations, values, strict=True):
                annotation.uint_value = value
            packet.track_event.flow_ids[:] = [flow] if flow else []
            octets = packet.SerializeToString() if flow else self._keep(key, packet)
        self._append(octets, cclk)

    def _beginning(self, name: str, arguments: tuple[str, ...]) -> Any:
        """Return the packet that begins a slice of this name, to be filled in."""
        packet = self._beginnings.get((name, arguments))
        if packet is None:
            packet = self._beginnings[name, arguments] = self._packet(
                type=proto.TrackEvent.TYPE_SLICE_BEGIN, name_iid=self._iid("event_names", name)
            )
            for each in arguments:
                iid = self._iid("debug_annotation_names", each)
                packet.track_event.debug_annotations.add(name_iid=iid)
        return packet

    def mark(self, cclk: int, name: str, flow: int) -> None:
        """Put a mark at a cycle, which shares the number `flow` with a slice."""
        packet = self._packet(type=proto.TrackEvent.TYPE_INSTANT, name_iid=self._iid("event_names", name))
        packet.track_event.flow_ids[:] = [flow]
        self._append(packet.SerializeToString(), cclk)

    def end(self, cclk: int) -> None:
        """End the slice that began last."""
        self._append(self._end, cclk)

    def count(self, cclk: int, value: int) -> None:
        """Note the value of a counter."""
        octets = self._known.get((value,))
        if octets is None:
            packet = self._packet(type=proto.TrackEvent.TYPE_COUNTER, counter_value=value)
            octets = self._keep((value,), packet)
        self._append(octets, cclk)

    def _keep(self, key: tuple[object, ...], packet: Any) -> bytes:
        """Return the bytes of a packet, and know them from now on."""
        if len(self._known) == _MOST_KNOWN:
            self._known.clear()
        octets: bytes = packet.SerializeToString()
        self._known[key] = octets
        return octets

    def _append(self, octets: bytes, cclk: int) -> None:
        """Write a packet, with its time."""
        factor, divisor = self._ns_of
        ns = cclk * factor // divisor
        octets += _stamp(ns - self._ns)
        self._ns = ns
        self._write(_head(len(octets)) + octets)

    def _iid(self, table: str, name: str) -> int:
        """Return the number of a name on this track; one that is new is told."""
        iid = self._iids.get((table, name))
        if iid is None:
            iid = self._iids[table, name] = len(self._iids) + 1
            packet = self._packet()
            getattr(packet.interned_data, table).add(iid=iid, name=name)
            self._write(_framed(packet))
        return iid

    def _packet(self, **event: int) -> Any:
        """Return a packet of the track with an event, if there is any."""
        return proto.TracePacket(
            trusted_packet_sequence_id=self._uuid,
            sequence_flags=proto.TracePacket.SEQ_NEEDS_INCREMENTAL_STATE,
            track_event=proto.TrackEvent(**event) if event else None,
        )


def _slice(track: _Track, span: Span) -> None:
    track.begin(span.begin_cclk, span.name)
    track.end(span.end_cclk)


def _wait(track: _Track, span: Span) -> None:
    """Write a wait, with a mark where it ends: an arrow leads to what begins later, and a wait may begin before its transfer."""
    track.begin(span.begin_cclk, span.name, span.flow)
    if span.flow:
        track.mark(span.end_cclk, _ENDED, span.flow)
    track.end(span.end_cclk)


def _moving(track: _Track, span: Span) -> None:
    track.begin(span.begin_cclk, span.name, span.flow, _MOVED, (span.value,))
    track.end(span.end_cclk)


def _call(track: _Track, span: Span) -> None:
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


def _level(track: _Track, span: Span) -> None:
    track.count(span.begin_cclk, span.value)


_WRITE: dict[SpanKind, Callable[[_Track, Span], None]] = {
    **dict.fromkeys(SpanKind, _slice),
    SpanKind.CALL: _call,
    SpanKind.STALL: _wait,
    SpanKind.IDLE: _wait,
    SpanKind.TRANSFER: _moving,
    SpanKind.MESSAGE: _moving,
    SpanKind.LEVEL: _level,
}


def _rank(name: str, order: Sequence[str]) -> int:
    """Return where a track stands among its siblings: by what its name begins with."""
    return next((number for number, each in enumerate(order) if name.startswith(each)), len(order))


def _varint(number: int) -> bytes:
    """Return a number in protobuf's bytes of seven bits, the lowest ones first."""
    octets = bytearray()
    while number > 0x7F:
        octets.append(number & 0x7F | 0x80)
        number >>= 7
    octets.append(number)
    return bytes(octets)


@lru_cache(1 << 10)
def _head(length: int) -> bytes:
    """Return what stands before a packet of so many bytes in a file: field 1 of a Trace."""
    return b"\x0a" + _varint(length)


@lru_cache(1 << 16)
def _stamp(ns: int) -> bytes:
    """Return the time of a packet: field 8 of a TracePacket."""
    return b"\x40" + _varint(ns)


def _framed(packet: Any) -> bytes:
    """Return a packet as it stands in a file: one comes behind the other."""
    octets: bytes = packet.SerializeToString()
    return _head(len(octets)) + octets
