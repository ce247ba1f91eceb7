"""A placement as a readable LDF, with a line for each buffer.

Memories, reserves and switches are those of the original LDF.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from textwrap import wrap

from bfsim.linker import LinkerScript
from bfsim.linker.filling import align_up
from bfsim.linker.script import (
    Assignment,
    Block,
    FixedReserve,
    Input,
    InputSections,
    OutputSection,
    Reserve,
    Segment,
)
from bfsim.placing.model import Part
from bfsim.placing.stretches import Stretch

WIDTH = 118
FILE = re.compile(r"[\w.][\w.-]*", re.ASCII)


class LdfWriter:
    """Writes placements of one firmware into the memories of one LDF, `script`."""

    def __init__(self, script: LinkerScript, stretches: Sequence[Stretch]) -> None:
        self._script = script
        self._stretches = stretches

    def text(
        self, parts: Sequence[Part], places: Sequence[int], why: Mapping[str, str], about: Iterable[str]
    ) -> str:
        """Return the LDF.

        `places`: the stretch of each part; `why`: a few words by the label of a part; `about`: the paragraphs at the
        top.
        """
        placed = sorted(zip(places, parts, strict=True), key=lambda each: each[0])
        lines = [
            *_comment(about),
            "",
            *([f"ARCHITECTURE({self._script.chip})"] if self._script.chip else []),
            "$OBJECTS = $COMMAND_LINE_OBJECTS;",
            *self._code_lists(placed),
            *(_assigned(each) for each in self._script.loose if each.expression.is_number),
            *_memory([each for each in self._script.segments if not each.processor], indent=""),
        ]
        for block in self._script.blocks:
            own = [(number, part) for number, part in placed if part.symbol.processor == block.processor]
            lines += ["", *self._block(block, own, why)]
        return "".join(f"{line.rstrip()}\n" for line in lines)

    def _code_lists(self, placed: Sequence[tuple[int, Part]]) -> Iterator[str]:
        """Yield a list of the object files of each core's code in each stretch."""
        for name, files in self._code_files(placed).items():
            yield f"{name} ="
            yield from wrap(f"{', '.join(files)};", WIDTH, initial_indent="   ", subsequent_indent="   ")

    def _code_files(self, placed: Sequence[tuple[int, Part]]) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}
        for number, part in placed:
            if part.is_code:
                found.setdefault(self._code_list(number, part), []).append(_file(part.symbol.object_file))
        return found

    def _code_list(self, number: int, part: Part) -> str:
        return f"$CODE_OF_{part.owner}_IN_{_plain(self._stretches[number].segment)}"

    def _block(
        self, block: Block, placed: Sequence[tuple[int, Part]], why: Mapping[str, str]
    ) -> Iterator[str]:
        title, _, name = block.title.partition(" ")
        own = [each for each in self._script.segments if each.processor and each.processor == block.processor]
        yield f"{title} {block.processors[0]}" if name else title
        yield "{"
        if not name:
            yield f"   MASTERS({', '.join(block.processors)})"
        yield from _memory(own, indent="   ")
        yield from (f"   {_assigned(each)}" for each in block.loose if each.expression.is_number)
        yield from (f"   RESOLVE({each.name}, 0x{each.address:08X})" for each in block.resolves)
        yield "   SECTIONS"
        yield "   {"
        yield from (f"      {_fixed(each)}" for each in self._fixed_of(block))
        yield from self._sections(block, placed, why)
        yield from _rest(block, self._script)
        yield "   }"
        yield "}"

    def _fixed_of(self, block: Block) -> list[FixedReserve]:
        first = next(each for each in self._script.blocks if each.processor == block.processor)
        return [
            each for each in self._script.reserves if block is first and each.processor == block.processor
        ]

    def _sections(
        self, block: Block, placed: Sequence[tuple[int, Part]], why: Mapping[str, str]
    ) -> Iterator[str]:
        """Yield an output section for each segment that holds something, its reserves first."""
        by_segment: dict[int, list[tuple[int, Part]]] = {}
        for number, part in placed:
            by_segment.setdefault(self._stretches[number].segment.start, []).append((number, part))
        reserves = _reserves_of(block, self._script)
        for start in sorted({*by_segment, *reserves}):
            segment = self._segment_at(start, block)
            align = next((each.align for each in self._stretches if each.segment.start == start), 1)
            yield ""
            yield f"      placed_in_{_plain(segment)}"
            yield "      {"
            yield f"         INPUT_SECTION_ALIGN({align})"
            yield from (
                f"         {_reserve(each)}" for each in reserves.get(start, ()) if not each.takes_rest
            )
            yield from self._inputs(by_segment.get(start, ()), why)
            yield from (f"         {_reserve(each)}" for each in reserves.get(start, ()) if each.takes_rest)
            yield f"      }} > {_plain(segment)}"

    def _segment_at(self, start: int, block: Block) -> Segment:
        """Return the segment at an address, by the name that a block has for it."""
        found = [each for each in self._script.segments if each.start == start]
        return next((each for each in found if each.processor == block.processor), found[0])

    def _inputs(self, placed: Sequence[tuple[int, Part]], why: Mapping[str, str]) -> Iterator[str]:
        code = [(self._code_list(number, part), part) for number, part in placed if part.is_code]
        for name, group in groupby(code, key=lambda each: each[0]):
            nbytes = sum(align_up(part.symbol.nbytes, 4) for _, part in group)
            yield f"         INPUT_SECTIONS_PIN({name}({code[0][1].symbol.section}))  // {nbytes:,} bytes of code"
        data = [part for _, part in placed if not part.is_code]
        inputs = [
            f"INPUT_SECTIONS_PIN({_file(each.symbol.object_file)}({_section(each.symbol.section)}))"
            for each in data
        ]
        width = max(map(len, inputs), default=0)
        for text, part in zip(inputs, data, strict=True):
            yield f"         {text:{width}}  // {_remark(why.get(part.label, ''))}"


def _comment(paragraphs: Iterable[str]) -> Iterator[str]:
    yield "/*"
    for number, each in enumerate(paragraphs):
        if number:
            yield "**"
        yield from wrap(_remark(each), WIDTH, initial_indent="** ", subsequent_indent="** ")
    yield "*/"


def _remark(text: str) -> str:
    """Return text that neither ends a comment nor begins one."""
    return re.sub(r"/\*|\*/|\\$", " ", " ".join(text.split()))


def _memory(segments: Sequence[Segment], indent: str) -> Iterator[str]:
    if not segments:
        return
    width = max(len(_plain(each)) for each in segments)
    yield ""
    yield f"{indent}MEMORY"
    yield f"{indent}{{"
    for each in segments:
        bounds = f"START(0x{each.start:08X}) END(0x{each.end:08X})"
        yield f"{indent}   {_plain(each):{width}} {{ TYPE(RAM) {bounds} WIDTH(8) }}"
    yield f"{indent}}}"
    yield ""


def _plain(segment: Segment) -> str:
    """Return the name of a segment in the block of its processor."""
    return segment.name.removeprefix(f"{segment.processor}.") if segment.processor else segment.name


def _assigned(assignment: Assignment) -> str:
    return f"{assignment.symbol} = {assignment.expression.number};"


def _fixed(reserve: FixedReserve) -> str:
    return f"RESERVE({reserve.name} = 0x{reserve.start:08X}, {reserve.length_name} = {reserve.nbytes})"


def _reserve(reserve: Reserve) -> str:
    if reserve.expands:
        return f"RESERVE_EXPAND({reserve.name}, {reserve.length_name} = {reserve.nbytes}, {reserve.nbytes}, {reserve.align})"
    if reserve.takes_rest:
        return f"RESERVE({reserve.name}, {reserve.length_name}, {reserve.nbytes}, {reserve.align})"
    return f"RESERVE({reserve.name}, {reserve.length_name} = {reserve.nbytes}, {reserve.align})"


def _reserves_of(block: Block, script: LinkerScript) -> dict[int, list[Reserve]]:
    """Return the reserves of a block without an address, by the start of their segment."""
    found: dict[int, list[Reserve]] = {}
    for output in block.output_sections:
        reserves = [each for each in output.statements if isinstance(each, Reserve)]
        if output.segment and reserves:
            found.setdefault(script.segment_by_name[output.segment].start, []).extend(reserves)
    return found


def _rest(block: Block, script: LinkerScript) -> Iterator[str]:
    """Yield the original output sections of the LDF, for everything without a line of its own."""
    yield ""
    yield "      /* What has no line above, such as a buffer that is new, goes where its section says. */"
    for output in block.output_sections:
        if output.segment:
            yield from _rest_of(output, script.segment_by_name[output.segment])


def _rest_of(output: OutputSection, segment: Segment) -> Iterator[str]:
    statements = [each for each in output.statements if isinstance(each, InputSections | Assignment)]
    yield f"      {output.name}"
    yield "      {"
    align = 1
    for each in statements:
        if isinstance(each, Assignment):
            if each.expression.is_number and each.symbol != ".":
                yield f"         {_assigned(each)}"
            continue
        inputs = [_input(source) for source in each.inputs if source.files]  # a filter may leave no file
        if not inputs:
            continue
        if each.align != align:
            align = each.align
            yield f"         INPUT_SECTION_ALIGN({align})"
        yield f"         INPUT_SECTIONS({' '.join(inputs)})"
    yield f"      }} > {_plain(segment)}"


def _input(source: Input) -> str:
    sections = " ".join(_section(each) for each in sorted(source.sections))
    return " ".join(f"{_file(each)}({sections})" for each in sorted(source.files))


def _file(name: str) -> str:
    return name if name.startswith("$") or FILE.fullmatch(name) else f'"{name}"'


def _section(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z_.*?][\w.*?$-]*", name, re.ASCII) else f'"{name}"'
