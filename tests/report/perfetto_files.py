"""Perfetto traces read back in tests, by Perfetto's own schema and by the rules of its manual, into slices and counters."""

from __future__ import annotations

import zlib
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from google.protobuf.unknown_fields import UnknownFieldSet
from perfetto.protos.perfetto.trace import perfetto_trace_pb2 as proto

CLEARED, NEEDED = (
    proto.TracePacket.SEQ_INCREMENTAL_STATE_CLEARED,
    proto.TracePacket.SEQ_NEEDS_INCREMENTAL_STATE,
)


@dataclass(slots=True)
class Slice:
    """A slice of a track; those within it are its children. A mark is one that ends where it begins."""

    name: str
    begin_ns: int
    end_ns: int = -1
    arguments: dict[str, int] = field(default_factory=dict)
    flows: tuple[int, ...] = ()
    children: list[Slice] = field(default_factory=list)


@dataclass(slots=True)
class Track:
    """A track with its name and that of its parent; its slices, or its samples as (ns, value)."""

    parent: str
    name: str
    is_counter: bool
    slices: list[Slice] = field(default_factory=list)
    samples: list[tuple[int, int]] = field(default_factory=list)
    last_ns: int = 0


@dataclass(slots=True)
class _Sequence:
    """What a packet sequence has told of itself."""

    ns: int = 0
    track_uuid: int = 0
    names: dict[int, str] = field(default_factory=dict)
    arguments: dict[int, str] = field(default_factory=dict)
    open: list[Slice] = field(default_factory=list)


def tracks_of(content: bytes) -> dict[tuple[str, str], Track]:
    """Read a trace; each packet must be understood with what came before it, and no slice may be left open or overlap."""
    tracks: dict[int, Track] = {}
    names = {0: ""}
    sequences: dict[int, _Sequence] = {}
    for packet in _packets(content):
        assert not any(
            len(UnknownFieldSet(each)) for each in (packet, packet.track_event, packet.track_descriptor)
        )
        if packet.HasField("track_descriptor"):
            track = packet.track_descriptor
            if track.uuid:
                assert track.uuid not in names, "described once"
                names[track.uuid] = track.name
                tracks[track.uuid] = Track(names[track.parent_uuid], track.name, track.HasField("counter"))
            continue
        number = packet.trusted_packet_sequence_id
        assert number > 0
        if packet.sequence_flags & CLEARED:
            sequences[number] = _opened(packet)
            continue
        assert packet.sequence_flags & NEEDED
        sequence = sequences[number]
        sequence.names |= {each.iid: each.name for each in packet.interned_data.event_names}
        sequence.arguments |= {each.iid: each.name for each in packet.interned_data.debug_annotation_names}
        if packet.HasField("track_event"):
            sequence.ns += packet.timestamp
            _play(packet.track_event, sequence, tracks[sequence.track_uuid])
    assert not any(each.open for each in sequences.values()), "every slice ends"
    by_name = {(each.parent, each.name): each for each in tracks.values()}
    assert len(by_name) == len(tracks)
    return by_name


def _packets(content: bytes) -> Iterator[Any]:
    for outer in proto.Trace.FromString(content).packet:
        assert outer.HasField("compressed_packets")
        yield from proto.Trace.FromString(zlib.decompress(outer.compressed_packets)).packet


def _opened(packet: Any) -> _Sequence:
    clocks = {each.clock_id: each for each in packet.clock_snapshot.clocks}
    clock = clocks[packet.trace_packet_defaults.timestamp_clock_id]
    assert 64 <= clock.clock_id < 128
    assert clock.is_incremental
    assert clocks[proto.BUILTIN_CLOCK_BOOTTIME].timestamp == clock.timestamp == 0
    return _Sequence(track_uuid=packet.trace_packet_defaults.track_event_defaults.track_uuid)


def _play(event: Any, sequence: _Sequence, track: Track) -> None:
    assert sequence.ns >= track.last_ns
    track.last_ns = sequence.ns
    if event.type == proto.TrackEvent.TYPE_COUNTER:
        assert track.is_counter
        track.samples.append((sequence.ns, event.counter_value))
        return
    assert not track.is_counter
    if event.type == proto.TrackEvent.TYPE_SLICE_END:
        sequence.open.pop().end_ns = sequence.ns
        return
    assert event.type in (proto.TrackEvent.TYPE_SLICE_BEGIN, proto.TrackEvent.TYPE_INSTANT)
    begun = Slice(
        name=sequence.names[event.name_iid],
        begin_ns=sequence.ns,
        arguments={sequence.arguments[each.name_iid]: each.uint_value for each in event.debug_annotations},
        flows=tuple(event.flow_ids),
    )
    (sequence.open[-1].children if sequence.open else track.slices).append(begun)
    if event.type == proto.TrackEvent.TYPE_INSTANT:
        begun.end_ns = begun.begin_ns
    else:
        sequence.open.append(begun)


def flows_of(tracks: dict[tuple[str, str], Track]) -> dict[int, list[tuple[str, Slice]]]:
    """Return the slices of each flow, and the tracks' names, in the order of time, as the arrows of Perfetto lead."""
    found: dict[int, list[tuple[str, Slice]]] = defaultdict(list)
    for (_, name), track in tracks.items():
        for each in track.slices:
            for part in (each, *each.children):
                for flow in part.flows:
                    found[flow].append((name, part))
    return {flow: sorted(each, key=lambda part: part[1].begin_ns) for flow, each in found.items()}
