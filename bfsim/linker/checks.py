"""What must hold before and after placement: symbols against each other, the LDF against the chip."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from bfsim.chip.memory_map import Region, regions_under
from bfsim.errors import ConfigError, LinkError
from bfsim.linker.link_map import LinkMap, Symbol
from bfsim.linker.script import LinkerScript, OutputSection, Segment
from bfsim.linker.source import LdfLine


def check_chip(script: LinkerScript, chip: str) -> None:
    """Raise LinkError for an LDF of another chip, or with other processors than it has."""
    if script.chip != chip.upper():
        raise LinkError(
            f"{script.path}: ARCHITECTURE must be {chip}, the board's chip, not {script.chip}; --board takes another board, of those "
            "that `bfsim boards` lists with their chips, and `bfsim ldf` shows the memories of an LDF for any Blackfin"
        )
    cores = script.core_of_processor
    for block in script.blocks:
        for name in block.processors:
            if name not in cores:
                known = " or ".join(cores)
                raise LinkError(f"{block.place}: processor must be {known} on an {chip}, not {name}")
    if len(cores) > 1 and len(set(cores.values())) == 1:
        raise LinkError(
            f"{script.path}: {chip} has one core, and the LDF must have one PROCESSOR, not {len(cores)}"
        )


def check_symbols(script: LinkerScript, symbols: Sequence[Symbol]) -> None:
    """Raise LinkError for an impossible size or alignment, an unknown processor, or a name that is taken."""
    processors = {name for block in script.blocks for name in block.processors}
    taken: dict[str, list[Symbol]] = {}
    for symbol in symbols:
        if symbol.nbytes < 0:
            raise LinkError(f"{symbol} must have a size of 0 bytes or more, not {symbol.nbytes}")
        if symbol.align < 1 or symbol.align & (symbol.align - 1):
            raise LinkError(f"{symbol} must be aligned to a power of two, not {symbol.align}")
        if symbol.processor is not None and symbol.processor not in processors:
            known = " or ".join(sorted(processors)) or "none"
            block = f"write a PROCESSOR {symbol.processor} that says where its sections go"
            raise LinkError(f"{symbol} must belong to a processor of {script.path} ({known}); {block}")
        for other in taken.setdefault(symbol.name, []):
            if symbol.processor == other.processor or None in (symbol.processor, other.processor):
                raise LinkError(
                    f"{symbol} (section {symbol.section}, {symbol.nbytes} bytes) must have a name of its "
                    f"own: {other} (section {other.section}, {other.nbytes} bytes) has it already"
                )
        taken[symbol.name].append(symbol)


def check_memories(script: LinkerScript, regions: Sequence[Region]) -> None:
    """Raise LinkError for a segment in use, or a fixed RESERVE, that has no memory or that its core does not reach."""
    _check_views(script)
    used = {output.segment for block in script.blocks for output in block.output_sections if output.segment}
    region_by_segment = {
        segment.name: region_under(segment, regions) for segment in script.segments if segment.name in used
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


def check_resolves(script: LinkerScript, link_map: LinkMap) -> None:
    """Raise LinkError if a symbol of the firmware did not land where a RESOLVE says it is."""
    for block in script.blocks:
        for resolve in block.resolves:
            for placed in link_map.placements:
                is_resolved = placed.symbol.name == resolve.name and block.serves(placed.symbol)
                if is_resolved and placed.address != resolve.address:
                    raise LinkError(
                        f"{resolve.place}: {placed.symbol} must lie at "
                        f"0x{resolve.address:08X}, where RESOLVE puts it, not at 0x{placed.address:08X}, "
                        f"where line {placed.line} does"
                    )


def _check_views(script: LinkerScript) -> None:
    """Check that the processors' own segments are the same memory or different ones."""
    by_address = sorted(script.segments, key=lambda each: (each.start, each.nbytes))
    for pair in pairwise(by_address):  # if any two are a part of each other, then so are two neighbours
        if pair[0].overlaps(pair[1]) and (pair[0].start, pair[0].nbytes) != (pair[1].start, pair[1].nbytes):
            left, right = sorted(pair, key=script.segments.index)
            raise LinkError(
                f"{right.place}: segment '{right.name}' of {right.processor} must be the same memory as "
                f"'{left.name}' of {left.processor} ({left.place.beside(right.place)}) or another, not a part of it"
            )


def region_under(segment: Segment, regions: Sequence[Region]) -> Region:
    """Return the memory under a segment, the first one of several; raise LinkError with its place in the LDF where there is none."""
    try:
        return regions_under(segment.start, segment.nbytes, regions)[0]
    except ConfigError as error:
        advice = (
            "`bfsim boards NAME` lists the memories of a board, --board takes another one, and --set sdram.bank_bytes=BYTES "
            "another size of each of the banks that SDRAM has"
        )
        raise LinkError(f"{segment.place}: segment '{segment.name}': {error}; {advice}") from None


def _check_reach(script: LinkerScript, segment: Segment, region: Region, user: str, place: LdfLine) -> None:
    """Check that the memory under a segment is shared, or belongs to the core that is to use it."""
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
