"""Builds a LinkerScript from the parse tree of an LDF: output sections, and the blocks they stand in."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from lark import Token, v_args

from bfsim.errors import LinkError
from bfsim.linker.evaluator import Evaluator, Files
from bfsim.linker.expressions import Expression
from bfsim.linker.predefined import chip_named
from bfsim.linker.script import (
    CORE_OF_PROCESSOR,
    Assignment,
    Block,
    FixedReserve,
    Input,
    InputSections,
    LinkerScript,
    Move,
    OutputSection,
    Reserve,
    Resolve,
    Segment,
)
from bfsim.linker.source import Source

# Keywords that would change a placement and are not modelled, each with the reason that the error gives.
_REFUSED = {
    "OVERLAY_INPUT": "overlays share an address at different times, and bfsim places each symbol once",
    "OVERLAY_GROUP": "overlays share an address at different times, and bfsim places each symbol once",
    "PLIT": "it belongs to overlays, and bfsim places each symbol once",
    "PACKING": "a Blackfin's memories are byte-wide, so there is nothing to pack",
    "MPMEMORY": "the two cores of a BF561 share memory through COMMON_MEMORY",
}


@dataclass(frozen=True, slots=True)
class Align:
    """An INPUT_SECTION_ALIGN: `nbytes`, for the INPUT_SECTIONS that follow it."""

    nbytes: int


@dataclass(frozen=True, slots=True)
class Contiguous:
    """A FORCE_CONTIGUITY."""


@dataclass(frozen=True, slots=True)
class Masters:
    """The MASTERS of a COMMON_MEMORY block."""

    processors: tuple[str, ...]


_Content = Align | Contiguous | InputSections | Reserve | FixedReserve | Assignment | Move
_Item = Segment | OutputSection | Reserve | FixedReserve | Resolve | Masters | Assignment | None


@v_args(inline=True)
class ScriptBuilder(Evaluator):
    """One method per rule of ldf.lark; raises LinkError at the first statement that makes no sense."""

    def __init__(self, source: Source) -> None:
        super().__init__(source)
        self._chip = ""
        self._processors: list[str] = []
        self._reserves: list[FixedReserve] = []

    def start(self, *items: Block | Segment | Assignment | None) -> LinkerScript:
        for each in self._lists.values():
            for name in each.later.values():
                self._files_of(name)
        everyone = tuple(self._processors) or tuple(CORE_OF_PROCESSOR)
        blocks = (item for item in items if isinstance(item, Block))
        return LinkerScript(
            self._source,
            self._chip,
            tuple(self._segments.values()),
            tuple(self._reserves),
            tuple(replace(block, processors=block.processors or everyone) for block in blocks),
            tuple(item for item in items if isinstance(item, Assignment)),
        )

    def architecture(self, chip: Token) -> None:
        self._chip = chip_named(chip)

    # ---- blocks

    def processor_head(self, name: Token) -> Token:
        if name in self._processors:
            raise self._error(name, f"PROCESSOR {name} must have one block, not a second one")
        self._processors.append(str(name))
        self._processor = str(name)
        return name

    def processor(self, name: Token, *items: _Item) -> Block:
        self._processor = ""
        return self._block(f"PROCESSOR {name}", (str(name),), name, items)

    def common_memory(self, keyword: Token, *items: _Item) -> Block:
        masters = _masters(items)
        if len(masters) != 1:
            raise self._error(keyword, f"COMMON_MEMORY must name its MASTERS once, not {len(masters)} times")
        return self._block(str(keyword), masters[0], keyword, items)

    def shared_memory(self, keyword: Token, *items: _Item) -> Block:
        masters = _masters(items)
        return self._block(str(keyword), masters[0] if masters else (), keyword, items)

    def masters(self, *names: Token) -> Masters:
        return Masters(tuple(map(str, names)))

    def resolve(self, name: Token, address: Expression | None = None) -> Resolve | None:
        """Build a RESOLVE to an address; one to a file says where to look, not where to place."""
        return Resolve(self._place(name), name.strip('"'), self._value(address)) if address else None

    def assignment(self, name: Token, value: Expression) -> Assignment:
        if value.is_number:
            self._constants[str(name)] = value.number
        return Assignment(self._place(name), str(name), value)

    def _block(self, title: str, processors: tuple[str, ...], token: Token, items: Iterable[_Item]) -> Block:
        items = tuple(items)
        for item in items:
            if isinstance(item, Reserve):
                problem = f"RESERVE({item.name}) outside an output section must have an address"
                raise LinkError(f"{item.place}: {problem}")
        return Block(
            self._place(token),
            title,
            processors,
            is_shared=not title.startswith("PROCESSOR"),
            output_sections=tuple(item for item in items if isinstance(item, OutputSection)),
            resolves=tuple(item for item in items if isinstance(item, Resolve)),
            loose=tuple(item for item in items if isinstance(item, Assignment)),
        )

    # ---- output sections

    def output_section(self, name: Token, *contents_and_segment: _Content | Token | None) -> OutputSection:
        *contents, segment = contents_and_segment
        target = ""
        if isinstance(segment, Token):
            target = self._known_segment(segment, segment.start_pos or 0).name
        statements: list[InputSections | Reserve | Assignment | Move] = []
        align = 1
        for content in contents:
            if isinstance(content, Align):
                align = content.nbytes
            elif isinstance(content, InputSections):
                statements.append(replace(content, align=align))
            elif isinstance(content, Reserve | Assignment | Move):
                statements.append(content)
        is_contiguous = any(isinstance(content, Contiguous) for content in contents)
        return OutputSection(self._place(name), str(name), tuple(statements), target, is_contiguous)

    def align(self, keyword: Token, nbytes: Expression) -> Align:
        return Align(self._alignment(keyword, nbytes))

    def move(self, align: Expression) -> Move:
        token = Token("NAME", "ALIGN", start_pos=align.offset)
        return Move(self._place(token), self._alignment(token, align))

    def contiguous(self) -> Contiguous:
        return Contiguous()

    def input_sections(self, keyword: Token, *inputs: Input) -> InputSections:
        is_exclusive = keyword.endswith("_EXCLUSIVE")
        return InputSections(self._place(keyword), inputs, 1, "_PIN" in keyword, is_exclusive)

    def input(self, files: Files | Token, *sections: str) -> Input:
        return Input(self._files_of(files), frozenset(sections))

    def section(self, name: Token) -> str:
        return name.strip('"')

    def reserve(
        self,
        name: Token,
        address: Expression | None,
        length_name: Token,
        length: Expression | None,
        third: Expression | None,
        fourth: Expression | None,
    ) -> Reserve | FixedReserve:
        """Build a RESERVE: with its length the third part is the alignment, without it the minimum."""
        if length is None:
            if address is not None:
                raise self._error(name, f"RESERVE({name}) must have a length with its address, not left out")
            rest = self._floating_reserve(name, length_name, third, fourth)
            return replace(rest, takes_rest=True)
        nbytes = self._value(length)
        if nbytes <= 0:
            raise self._error(name, f"RESERVE({name}) must have a length of 1 byte or more, not {nbytes}")
        if address is None:
            return self._floating_reserve(name, length_name, length, third)
        reserved = FixedReserve(
            self._place(name),
            str(name),
            str(length_name),
            self._value(address),
            nbytes,
            self._processor or None,
        )
        self._reserves.append(reserved)
        return reserved

    def reserve_expand(
        self,
        name: Token,
        length_name: Token,
        length: Expression | None,
        minimum: Expression | None,
        align: Expression | None,
    ) -> Reserve:
        return replace(self._floating_reserve(name, length_name, minimum or length, align), expands=True)

    def _floating_reserve(
        self, name: Token, length_name: Token, length: Expression | None, align: Expression | None
    ) -> Reserve:
        nbytes = self._value(length) if length else 0
        if nbytes < 0:
            raise self._error(name, f"RESERVE({name}) must have a length of 0 bytes or more, not {nbytes}")
        alignment = self._alignment(name, align) if align else 1
        return Reserve(self._place(name), str(name), str(length_name), nbytes, alignment)

    def _alignment(self, token: Token, expression: Expression) -> int:
        nbytes = self._value(expression)
        if nbytes < 1 or nbytes & (nbytes - 1):
            raise self._error(token, f"alignment must be a power of two, not {nbytes}")
        return nbytes

    # ---- what is refused where it stands

    def _refuse(self, keyword: Token, *_parts: object) -> None:
        raise self._error(keyword, f"LDF must do without {keyword}: {_REFUSED[keyword]}")

    packing = plit = overlay_group = overlay_input = mpmemory = _refuse


def _masters(items: Iterable[_Item]) -> list[tuple[str, ...]]:
    return [item.processors for item in items if isinstance(item, Masters)]
