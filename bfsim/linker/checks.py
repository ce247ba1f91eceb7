"""What must hold before and after placement: symbols against each other, the LDF against the chip."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from bfsim.chip.memory_map import Region, region_of
from bfsim.errors import ConfigError, LinkError
from bfsim.linker.link_map import LinkMap, Symbol
from bfsim.linker.script import CORE_OF_PROCESSOR, LinkerScript, OutputSection, Segment


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
            raise LinkError(f"{symbol} must belong to a processor of {script.path} ({known})")
        for other in taken.setdefault(symbol.name, []):
            if symbol.processor == other.processor or None in (symbol.processor, other.processor):
                raise LinkError(
                    f"{symbol} (section {symbol.section}, {symbol.nbytes} bytes) must have a name of its "
                    f"own: {other} (section {other.section}, {other.nbytes} bytes) has it already"
                )
        taken[symbol.name].append(symbol)


def check_memories(script: LinkerScript, regions: Sequence[Region]) -> None:
    """Raise LinkError for a segment or fixed RESERVE that has no memory, or that its core does not reach."""
    region_by_segment = {segment.name: _region_under(script, segment, regions) for segment in script.segments}
    for segment in script.segments:
        if segment.processor:
            _check_reach(script, segment, region_by_segment[segment.name], segment.processor, segment.line)
    segments = {segment.name: segment for segment in script.segments}
    for block in script.blocks:
        for output in block.output_sections:
            segment = segments[output.segment]
            user = "both cores" if block.is_shared else block.processors[0]
            _check_reach(script, segment, region_by_segment[segment.name], user, output.line)
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
                        f"{script.path}:{resolve.line}: {placed.symbol} must lie at "
                        f"0x{resolve.address:08X}, where RESOLVE puts it, not at 0x{placed.address:08X}, "
                        f"where line {placed.line} does"
                    )


def _region_under(script: LinkerScript, segment: Segment, regions: Sequence[Region]) -> Region:
    try:
        return region_of(segment.start, segment.nbytes, regions)
    except ConfigError as error:
        raise LinkError(f"{script.path}:{segment.line}: segment '{segment.name}': {error}") from None


def _check_reach(script: LinkerScript, segment: Segment, region: Region, user: str, line: int) -> None:
    """Check that the memory under a segment is shared, or belongs to the core that is to use it."""
    if region.owner not in ("shared", CORE_OF_PROCESSOR.get(user)):
        raise LinkError(
            f"{script.path}:{line}: segment '{segment.name}' lies in {region.name}, which only core "
            f"{region.owner} reaches: it must be used by that core alone, not by {user}"
        )


def _check_unbroken(script: LinkerScript, segment: Segment, output: OutputSection) -> None:
    """Check that FORCE_CONTIGUITY holds: a reserve may lie at the end of the segment only."""
    for reserved in script.reserves:
        if segment.start <= reserved.start <= segment.end and reserved.start + reserved.nbytes <= segment.end:
            raise LinkError(
                f"{script.path}:{output.line}: segment of FORCE_CONTIGUITY section '{output.name}' must be "
                f"in one piece, not {segment.name}, cut by RESERVE({reserved.name}) of line {reserved.line}"
            )


def _check_reserves(script: LinkerScript) -> None:
    reserves = sorted(script.reserves, key=lambda reserved: reserved.start)
    for reserved in reserves:
        end = reserved.start + reserved.nbytes - 1
        if not any(segment.start <= reserved.start and end <= segment.end for segment in script.segments):
            raise LinkError(
                f"{script.path}:{reserved.line}: RESERVE({reserved.name}) must lie inside one segment of "
                f"MEMORY, not at 0x{reserved.start:08X}-0x{end:08X}"
            )
    for left, right in pairwise(reserves):
        if right.start < left.start + left.nbytes:
            raise LinkError(
                f"{script.path}:{right.line}: RESERVE({right.name}) at 0x{right.start:08X} must not overlap "
                f"RESERVE({left.name}) of line {left.line}"
            )
