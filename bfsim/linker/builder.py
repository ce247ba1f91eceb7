"""Builds a LinkerScript from the parse tree of an LDF: output sections, and the blocks they stand in."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from lark import Token, v_args

from bfsim.errors import LinkError
from bfsim.linker.evaluator import Evaluator
from bfsim.linker.script import (
    CORE_OF_PROCESSOR,
    Block,
    FixedReserve,
    Input,
    InputSections,
    LinkerScript,
    OutputSection,
    Reserve,
    Resolve,
    Segment,
)
from bfsim.linker.source import Source

ARCHITECTURE = "ADSP-BF561"
PROCESSORS = tuple(CORE_OF_PROCESSOR)


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


_Content = Align | Contiguous | InputSections | Reserve | FixedReserve
_Item = Segment | OutputSection | Reserve | FixedReserve | Resolve | Masters | None


@v_args(inline=True)
class ScriptBuilder(Evaluator):
    """One method per rule of ldf.lark; raises LinkError at the first statement that cannot be meant."""

    def __init__(self, source: Source) -> None:
        super().__init__(source)
        self._reserves: list[FixedReserve] = []
        self._processors: list[str] = []

    def start(self, *items: Block | Segment | None) -> LinkerScript:
        blocks = tuple(item for item in items if isinstance(item, Block))
        return LinkerScript(self._source.path, tuple(self._segments.values()), tuple(self._reserves), blocks)

    def architecture(self, chip: Token) -> None:
        if chip != ARCHITECTURE:
            raise self._error(chip, f"ARCHITECTURE must be {ARCHITECTURE}, not {chip}")

    # ---- blocks

    def processor(self, name: Token, *items: _Item) -> Block:
        self._check_processor(name)
        if name in self._processors:
            raise self._error(name, f"PROCESSOR {name} must have one block, not a second one")
        self._processors.append(str(name))
        for segment in (item for item in items if isinstance(item, Segment)):
            self._segments[segment.name] = replace(segment, processor=str(name))
        return self._block(f"PROCESSOR {name}", (str(name),), name, items)

    def common_memory(self, keyword: Token, *items: _Item) -> Block:
        masters = [item.processors for item in items if isinstance(item, Masters)]
        if len(masters) != 1:
            raise self._error(keyword, f"COMMON_MEMORY must name its MASTERS once, not {len(masters)} times")
        return self._block(str(keyword), masters[0], keyword, items)

    def shared_memory(self, keyword: Token, *items: _Item) -> Block:
        return self._block(str(keyword), PROCESSORS, keyword, items)

    def masters(self, *names: Token) -> Masters:
        for name in names:
            self._check_processor(name)
        return Masters(tuple(map(str, names)))

    def resolve(self, name: Token, address: int) -> Resolve:
        return Resolve(str(name), address, self._line(name))

    def _check_processor(self, name: Token) -> None:
        if name not in PROCESSORS:
            raise self._error(
                name, f"processor must be {' or '.join(PROCESSORS)} on an {ARCHITECTURE}, not {name}"
            )

    def _block(self, title: str, processors: tuple[str, ...], token: Token, items: Iterable[_Item]) -> Block:
        items = tuple(items)
        for item in items:
            if isinstance(item, Reserve):
                where = f"{self._source.path}:{item.line}"
                raise LinkError(
                    f"{where}: RESERVE({item.name}) outside an output section must have an address"
                )
        sections = tuple(item for item in items if isinstance(item, OutputSection))
        resolves = tuple(item for item in items if isinstance(item, Resolve))
        is_shared = not title.startswith("PROCESSOR")
        return Block(title, processors, is_shared, sections, resolves, self._line(token))

    # ---- output sections

    def output_section(self, name: Token, *contents_and_segment: _Content | Token) -> OutputSection:
        *contents, segment = contents_and_segment
        assert isinstance(segment, Token)
        self._known_segment(segment)
        statements: list[InputSections | Reserve] = []
        align = 1
        for content in contents:
            if isinstance(content, Align):
                align = content.nbytes
            elif isinstance(content, InputSections):
                statements.append(replace(content, align=align))
            elif isinstance(content, Reserve):
                statements.append(content)
        is_contiguous = any(isinstance(content, Contiguous) for content in contents)
        return OutputSection(str(name), tuple(statements), str(segment), is_contiguous, self._line(name))

    def align(self, keyword: Token, nbytes: int) -> Align:
        self._check_align(keyword, nbytes)
        return Align(nbytes)

    def contiguous(self) -> Contiguous:
        return Contiguous()

    def input_sections(self, keyword: Token, *inputs: Input) -> InputSections:
        return InputSections(inputs, 1, self._line(keyword))

    def input(self, files: frozenset[str], *sections: Token) -> Input:
        return Input(files, frozenset(map(str, sections)))

    def reserve(
        self, name: Token, address: int | None, nbytes: int | None, align: int | None
    ) -> Reserve | FixedReserve:
        if nbytes is None or nbytes <= 0:
            said = "left out" if nbytes is None else str(nbytes)
            raise self._error(name, f"RESERVE({name}) must have a length of 1 byte or more, not {said}")
        if address is None:
            return self._floating_reserve(name, nbytes, align)
        reserved = FixedReserve(str(name), address, nbytes, self._line(name))
        self._reserves.append(reserved)
        return reserved

    def reserve_expand(self, name: Token, minimum_nbytes: int | None, align: int | None) -> Reserve:
        """Reserve the least that will do: it expands into what is free when everything else has its place."""
        return self._floating_reserve(name, minimum_nbytes or 0, align)

    def _floating_reserve(self, name: Token, nbytes: int, align: int | None) -> Reserve:
        align = 1 if align is None else align
        self._check_align(name, align)
        return Reserve(str(name), nbytes, align, self._line(name))

    def _check_align(self, token: Token, nbytes: int) -> None:
        if nbytes < 1 or nbytes & (nbytes - 1):
            raise self._error(token, f"alignment must be a power of two, not {nbytes}")
