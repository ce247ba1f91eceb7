"""Checks of an LDF's segments: each must lie in a memory of the board that its core reaches, with reserves inside it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from bfsim.chip.checks import MOST_OUTSIDE_L1
from bfsim.chip.memory_map import Region, regions_under
from bfsim.errors import ConfigError, LinkError
from bfsim.linker.script import LinkerScript, OutputSection, Segment
from bfsim.linker.source import LdfLine


def check_memories(script: LinkerScript, regions: Sequence[Region]) -> None:
    """Raise LinkError for a segment in use, or a fixed RESERVE, that has no memory or that its core does not reach."""
    _check_views(script)
    used = {output.segment for block in script.blocks for output in block.output_sections if output.segment}
    highest_first = sorted(
        script.segments, key=lambda each: each.end, reverse=True
    )  # the advice for it is good for all
    region_by_segment = {
        segment.name: region_under(segment, regions) for segment in highest_first if segment.name in used
    }
    for name, region in region_by_segment.items():
        segment = script.segment_by_name[name]
        if segment.processor:
            _check_reach(script, segment, region, segment.processor, segment.place)
    for block in script.blocks:
        for output in block.output_sections:
            if not output.segment:
                continue
            segment = script.segment_by_name[output.segment]
            user = block.processor or "both cores"
            _check_reach(script, segment, region_by_segment[segment.name], user, output.place)
            if output.is_contiguous:
                _check_unbroken(script, segment, output)
    _check_reserves(script)


def _check_views(script: LinkerScript) -> None:
    """Check that the processors' own segments are the same memory or different ones."""
    by_address = sorted(script.segments, key=lambda each: (each.start, each.nbytes))
    for pair in pairwise(by_address):  # if any two overlap in part, so do two neighbours
        if pair[0].overlaps(pair[1]) and (pair[0].start, pair[0].nbytes) != (pair[1].start, pair[1].nbytes):
            left, right = sorted(pair, key=script.segments.index)
            raise LinkError(
                f"{right.place}: segment '{right.name}' of {right.processor} must be the same memory as "
                f"'{left.name}' of {left.processor} ({left.place.beside(right.place)}) or another, not a part of it"
            )


def region_under(segment: Segment, regions: Sequence[Region]) -> Region:
    """Return the memory under a segment, the first of several; raise LinkError with the segment's place if there is none."""
    try:
        return regions_under(segment.start, segment.nbytes, regions)[0]
    except ConfigError as error:
        raise LinkError(
            f"{segment.place}: segment '{segment.name}': {error}; {_advice(segment, regions)}"
        ) from None


def _advice(segment: Segment, regions: Sequence[Region]) -> str:
    """Return what to do about a segment without memory: another board, or more SDRAM if the model has addresses for it."""
    boards = "`bfsim boards NAME` lists the memories of a board"
    l2 = sum(each.nbytes for each in regions if each.memory == "L2")
    after_sdram = min((each.start for each in regions if each.start), default=0)
    wanted, most = 1 << segment.end.bit_length(), 1 << (MOST_OUTSIDE_L1 - l2).bit_length() - 1
    if segment.end >= after_sdram:
        return f"{boards}, and --board takes another one"
    if wanted > most:
        return (
            f"{boards}, and none can have more than {most:,} bytes of SDRAM here: end the segment below 0x{most:08X}, or "
            "let no section go there"
        )
    return (
        f"{boards}, --board takes another one, and --set sdram.bank_bytes=BYTES another size of each of the banks that SDRAM has, "
        f"which must have {wanted:,} bytes together"
    )


def _check_reach(script: LinkerScript, segment: Segment, region: Region, user: str, place: LdfLine) -> None:
    """Check that the memory under a segment is shared, or belongs to the core that uses it."""
    if region.owner not in ("shared", script.core_of_processor.get(user)):
        raise LinkError(
            f"{place}: segment '{segment.name}' lies in {region.name}, which only core "
            f"{region.owner} reaches: it must be used by that core alone, not by {user}"
        )


def _check_unbroken(script: LinkerScript, segment: Segment, output: OutputSection) -> None:
    """Check that FORCE_CONTIGUITY holds: a reserve may lie at the start or the end of the segment only."""
    for reserved in script.reserves:
        if segment.start < reserved.start and reserved.start + reserved.nbytes <= segment.end:
            raise LinkError(
                f"{output.place}: segment of FORCE_CONTIGUITY section '{output.name}' must be "
                f"in one piece, not {segment.name}, cut by RESERVE({reserved.name}) of {reserved.place.beside(output.place)}"
            )


def _check_reserves(script: LinkerScript) -> None:
    reserves = sorted(script.reserves, key=lambda reserved: reserved.start)
    for reserved in reserves:
        end = reserved.start + reserved.nbytes - 1
        segment = script.segment_of(reserved)
        if segment is None or end > segment.end:
            raise LinkError(
                f"{reserved.place}: RESERVE({reserved.name}) must lie inside one segment of "
                f"MEMORY, not at 0x{reserved.start:08X}-0x{end:08X}"
            )
    for left, right in pairwise(reserves):
        if right.start < left.start + left.nbytes and not left.is_same_as(right):
            raise LinkError(
                f"{right.place}: RESERVE({right.name}) at 0x{right.start:08X} must not overlap "
                f"RESERVE({left.name}) of {left.place.beside(right.place)}"
            )
