"""What must hold before and after placement: symbols against each other and the LDF, the LDF against the chip."""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.errors import LinkError
from bfsim.linker.link_map import LinkMap, Symbol
from bfsim.linker.script import LinkerScript


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
