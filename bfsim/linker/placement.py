"""Gives every symbol its address, in the way the default LDFs of VisualDSP++ rely on.

Blocks, output sections and their statements are taken in the order of the file, the symbols of a statement in
the order of the call. Each segment has one location pointer, whichever core fills it. A symbol that does not
fit waits for the next output section that names its input section; one that waits at the end is an error.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from bfsim.chip.memory_map import CM_BF561_REGIONS, Region
from bfsim.errors import LinkError, cut
from bfsim.linker.checks import check_chip, check_resolves, check_symbols
from bfsim.linker.filling import Filling, align_up
from bfsim.linker.link_map import LinkMap, Placement, SegmentUsage, Symbol
from bfsim.linker.memory_checks import check_memories
from bfsim.linker.reserves import Reserved, expanded
from bfsim.linker.script import (
    COMMAND_LINE_OBJECTS,
    Assignment,
    Block,
    FixedReserve,
    Input,
    InputSections,
    LinkerScript,
    Move,
    OutputSection,
    Reserve,
    Statement,
)
from bfsim.linker.source import LdfLine
from bfsim.linker.values import Key, Values

PLACE_IT = "`bfsim place --ldf` with this LDF writes one in which it lies elsewhere, if there is room"


@dataclass(frozen=True, slots=True)
class Refusal:
    """An output section without room for a symbol: the statement's place, and how full the segment was."""

    output_section: str
    place: LdfLine
    align: int
    usage: SegmentUsage


def link(
    script: LinkerScript,
    symbols: Sequence[Symbol],
    regions: Sequence[Region] = CM_BF561_REGIONS,
    *,
    chip: str = "ADSP-BF561",
) -> LinkMap:
    """Place `symbols` by `script` in the memories `regions` of a board with a `chip`; raise LinkError if one has no place."""
    if not script.chip:
        script = replace(script, chip=chip)  # an LDF without ARCHITECTURE is for any chip
    check_chip(script, chip)
    check_symbols(script, symbols)
    check_memories(script, regions)
    linker = _Linker(script, symbols)
    for assignment in script.loose:
        linker.values.assign(None, assignment)
    for block in script.blocks:
        for assignment in block.loose:
            linker.values.assign(block.processor, assignment)
        for output in block.output_sections:
            if output.segment:
                linker.fill(block, output)
    waiting = [symbol for symbol in symbols if symbol not in linker.placed]
    if waiting:
        raise linker.error_about(waiting)
    link_map = linker.link_map()
    check_resolves(script, link_map)
    return link_map


class _Linker:
    """One link: the segments as they fill, the symbols that have a place, and the sections that had no room for a symbol."""

    def __init__(self, script: LinkerScript, symbols: Sequence[Symbol]) -> None:
        self._script = script
        self._symbols = symbols
        self._by_section: dict[str, list[int]] = {}  # numbers of symbols
        for number, symbol in enumerate(symbols):
            self._by_section.setdefault(symbol.section, []).append(number)
        self.fillings = _fillings(script)
        self.placed: dict[Symbol, Placement] = {}
        self.values = Values(script)
        self._reserves: list[Reserved] = []
        self._filled: list[OutputSection] = []
        self._pins = _pins(script)
        self._extents: dict[Key, tuple[int, int]] = {}
        self._refusals: dict[Symbol, list[Refusal]] = {}

    def fill(self, block: Block, output: OutputSection) -> None:
        """Place the symbols that `output` takes and has room for, and obey its other statements."""
        processor = block.processor
        filling = self.fillings[output.segment]
        start = filling.location
        for statement in output.statements:
            match statement:
                case Reserve():
                    self._reserve(processor, output, statement)
                case Assignment(symbol="."):
                    self._move(
                        output, statement, self.values.location_of(processor, statement, filling.location)
                    )
                case Assignment():
                    self.values.assign(processor, statement, filling.location)
                case Move():
                    self._move(output, statement, align_up(filling.location, statement.align))
                case InputSections():
                    for symbol in self._in_sections(statement):
                        is_waiting = symbol not in self.placed and block.serves(symbol)
                        if is_waiting and self._takes(output, statement, symbol):
                            self._place(symbol, output, statement)
        self._filled.append(output)
        self._extents.setdefault((processor, output.name), (start, filling.location - start))

    def _in_sections(self, statement: InputSections) -> Sequence[Symbol]:
        """Return the symbols of the sections that a statement names, in the order of the call."""
        sections = frozenset[str]().union(*(each.sections for each in statement.inputs))
        if any(character in name for name in sections for character in "*?"):
            return self._symbols
        found = sorted(number for name in sections for number in self._by_section.get(name, ()))
        return [self._symbols[number] for number in found]

    def link_map(self) -> LinkMap:
        """Return what was placed, after the reserves that expand have taken what is free."""
        placements = list(self.placed.values())
        reserves = expanded(self._script, self._reserves, placements, self.fillings)
        reserved = {(r.processor, r.name): r.start for r in reserves}
        reserved |= {(r.processor, r.length_name): r.nbytes for r in reserves}
        addresses = {(p.symbol.processor, p.symbol.name): p.address for p in placements}
        values = self.values.settle(addresses, self._extents, reserved)
        usages = [self.fillings[segment.name].usage_of(segment) for segment in self._script.segments]
        return LinkMap(placements, usages, reserves, values)

    def _takes(self, output: OutputSection, statement: InputSections, symbol: Symbol) -> bool:
        """Return whether a statement of `output` takes a symbol that is not pinned elsewhere."""
        return statement.takes(symbol) and not any(
            pinned is not output and (pin.is_exclusive or pinned not in self._filled) and pin.takes(symbol)
            for block, pinned, pin in self._pins
            if block.serves(symbol)
        )

    def _place(self, symbol: Symbol, output: OutputSection, statement: InputSections) -> None:
        filling = self.fillings[output.segment]
        align = max(symbol.align, statement.align)
        if filling.has_room(symbol.nbytes, align):
            address = filling.take(symbol.nbytes, align)
            self.placed[symbol] = Placement(symbol, output.segment, output.name, address, statement.line)
        else:
            refusal = Refusal(output.name, statement.place, align, filling.usage)
            self._refusals.setdefault(symbol, []).append(refusal)

    def _reserve(self, processor: str | None, output: OutputSection, reserve: Reserve) -> None:
        filling = self.fillings[output.segment]
        if not filling.has_room(reserve.nbytes, reserve.align):
            what = f"RESERVE({reserve.name}, {reserve.nbytes} bytes, align {reserve.align})"
            raise LinkError(_out_of_memory(reserve.place, output.name, what, filling.usage))
        address = filling.address_for(reserve.nbytes, reserve.align)
        nbytes = filling.rest_at(address) if reserve.takes_rest else reserve.nbytes
        filling.take(nbytes, reserve.align)
        self._reserves.append(Reserved(reserve, processor, output, address, nbytes))

    def _move(self, output: OutputSection, statement: Statement, address: int) -> None:
        filling = self.fillings[output.segment]
        here = filling.location
        if not filling.move_to(address):
            raise LinkError(
                f"{statement.place}: location counter of output section '{output.name}' must stay inside "
                f"{filling.segment.name} and go up from 0x{here:08X}, not to 0x{address & 0xFFFFFFFF:08X}"
            )

    def error_about(self, waiting: Sequence[Symbol]) -> LinkError:
        """Return the LinkError for the first of the symbols that found no place."""
        symbol = waiting[0]
        if symbol not in self._refusals:
            return self._not_taken(symbol)
        *before, last = self._refusals[symbol]
        what = f"{symbol} (section {symbol.section}, {symbol.nbytes} bytes, align {last.align})"
        message = _out_of_memory(last.place, last.output_section, what, last.usage)
        elsewhere = {each.usage.name: each for each in before if each.usage.name != last.usage.name}
        for refusal in elsewhere.values():
            message += (
                f"; nor in {_fullness(refusal.usage)} "
                f"('{refusal.output_section}', {refusal.place.beside(last.place)})"
            )
        if len(waiting) > 1:
            nbytes = sum(other.nbytes for other in waiting)
            message += f"; in all {len(waiting)} symbols, {nbytes} bytes, are left without a place"
        return LinkError(f"{message}{self._of_other_files(symbol)}; {PLACE_IT}")

    def _not_taken(self, symbol: Symbol) -> LinkError:
        """Return the LinkError for a symbol whose input section no output section takes from its file."""
        owner = symbol.processor or "both cores"
        sources = [source for _, source in self._inputs_for(symbol)]
        taken = sorted({name for source in sources if source.takes_file(symbol) for name in source.sections})
        return LinkError(
            f"{self._script.path}: section of {symbol} ({symbol.object_file}, {symbol.nbytes} bytes) must "
            f"be one that the LDF takes for {owner} ({', '.join(taken) or 'none'}), "
            f"not {symbol.section}{self._of_other_files(symbol) or _add(symbol)}; {PLACE_IT}"
        )

    def _of_other_files(self, symbol: Symbol) -> str:
        """Return the end of an error: the first statement that takes the symbol's section of other files; '' if none does.

        The wizard of VisualDSP++ writes such LDFs for a project with sub-projects, whose output are the libraries
        sml2.dlb and sml3.dlb.
        """
        for statement, source in self._inputs_for(symbol):
            if source.files and source.takes_section(symbol) and not source.takes_file(symbol):
                where = statement.place.beside(LdfLine(self._script.path, 0))
                return (
                    f"; {where} takes {symbol.section} only of {cut(', '.join(sorted(source.files)))}: add {symbol.object_file} to "
                    f"its files, or {COMMAND_LINE_OBJECTS}, which is all of the firmware, the code with it"
                )
        return ""

    def _inputs_for(self, symbol: Symbol) -> Iterator[tuple[InputSections, Input]]:
        """Yield what the output sections of the symbol's core take, with the statements."""
        for block in self._script.blocks:
            if not block.serves(symbol):
                continue
            for output in block.output_sections:
                for statement in output.statements:
                    if isinstance(statement, InputSections):
                        yield from ((statement, source) for source in statement.inputs)


def _add(symbol: Symbol) -> str:
    return f"; an output section with INPUT_SECTIONS({COMMAND_LINE_OBJECTS}({symbol.section})) would take it"


def _fullness(usage: SegmentUsage) -> str:
    return f"{usage.name}: {usage.free_bytes} of {usage.nbytes} bytes free"


def _out_of_memory(place: LdfLine, output_section: str, what: str, usage: SegmentUsage) -> str:
    return (
        f"{place}: Out of memory in output section '{output_section}' [li1040]: "
        f"{what} does not fit in {_fullness(usage)}"
    )


def _pins(script: LinkerScript) -> list[tuple[Block, OutputSection, InputSections]]:
    """Return the INPUT_SECTIONS_PIN statements, each with its output section and block."""
    return [
        (block, output, statement)
        for block in script.blocks
        for output in block.output_sections
        for statement in output.statements
        if isinstance(statement, InputSections) and statement.is_pinned
    ]


def _fillings(script: LinkerScript) -> dict[str, Filling]:
    """Return a filling for each segment; segments of several processors for the same memory share one."""
    reserves: dict[tuple[int, int], list[FixedReserve]] = {}
    for reserved in script.reserves:
        if segment := script.segment_of(reserved):
            reserves.setdefault((segment.start, segment.nbytes), []).append(reserved)
    by_range = {
        (each.start, each.nbytes): Filling(each, reserves.get((each.start, each.nbytes), ()))
        for each in reversed(script.segments)
    }
    return {each.name: by_range[each.start, each.nbytes] for each in script.segments}
