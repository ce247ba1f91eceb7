"""A track of Perfetto's timeline as protobuf: slices, marks and counts, each at its time."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from typing import Any

from perfetto.protos.perfetto.trace import perfetto_trace_pb2 as proto

_CLOCK, _BOOTTIME = 64, proto.BUILTIN_CLOCK_BOOTTIME
_MOST_KNOWN = 1 << 14
"""The number of packets that are kept for each track."""
NS = 1_000_000_000


def ns_of(cclk: int, cclk_hz: Fraction) -> int:
    """Return the last whole ns at or before a cycle."""
    return cclk * NS * cclk_hz.denominator // cclk_hz.numerator


class Track:
    """One track, as a sequence of packets: its clock counts ns from the previous packet, and names are sent once.

    What all its packets share is a default. Packets that differ only in their time are built once: the time is
    appended, since fields may come in any order.
    """

    def __init__(self, uuid: int, cclk_hz: Fraction, write: Callable[[bytes], None]) -> None:
        self._uuid = uuid
        self._write = write
        self._cclk_hz = cclk_hz
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
        write(framed(first))

    def begin(
        self,
        cclk: int,
        name: str,
        flow: int = 0,
        arguments: tuple[str, ...] = (),
        values: tuple[int, ...] = (),
    ) -> None:
        """Begin a slice at a cycle. `flow`: a number that it shares with another slice, or 0; few slices have one."""
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
        """Put a mark at a cycle; it shares the number `flow` with a slice."""
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
        """Return the bytes of a packet, and keep them for later."""
        if len(self._known) == _MOST_KNOWN:
            self._known.clear()
        octets: bytes = packet.SerializeToString()
        self._known[key] = octets
        return octets

    def _append(self, octets: bytes, cclk: int) -> None:
        """Write a packet, with its time."""
        ns = ns_of(cclk, self._cclk_hz)
        octets += _stamp(ns - self._ns)
        self._ns = ns
        self._write(_head(len(octets)) + octets)

    def _iid(self, table: str, name: str) -> int:
        """Return the number of a name on this track; a new name is sent first."""
        iid = self._iids.get((table, name))
        if iid is None:
            iid = self._iids[table, name] = len(self._iids) + 1
            packet = self._packet()
            getattr(packet.interned_data, table).add(iid=iid, name=name)
            self._write(framed(packet))
        return iid

    def _packet(self, **event: int) -> Any:
        """Return a packet of the track, with an event if there is one."""
        return proto.TracePacket(
            trusted_packet_sequence_id=self._uuid,
            sequence_flags=proto.TracePacket.SEQ_NEEDS_INCREMENTAL_STATE,
            track_event=proto.TrackEvent(**event) if event else None,
        )


def _varint(number: int) -> bytes:
    """Return a number as a varint of protobuf: seven bits per byte, the lowest first."""
    octets = bytearray()
    while number > 0x7F:
        octets.append(number & 0x7F | 0x80)
        number >>= 7
    octets.append(number)
    return bytes(octets)


@lru_cache(1 << 10)
def _head(length: int) -> bytes:
    """Return the head of a packet of `length` bytes in a file: field 1 of a Trace."""
    return b"\x0a" + _varint(length)


@lru_cache(1 << 16)
def _stamp(ns: int) -> bytes:
    """Return the time of a packet: field 8 of a TracePacket."""
    return b"\x40" + _varint(ns)


def framed(packet: Any) -> bytes:
    """Return a packet as it stands in a file, one after the other."""
    octets: bytes = packet.SerializeToString()
    return _head(len(octets)) + octets
