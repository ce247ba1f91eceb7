"""A row of the instruction table: encoding, assembler text, what it does, and what may stand beside it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from string import Formatter

from bfsim.blackfin.instructions.operands import KINDS, NUMBER, Operand, OperandKind

Given = Mapping[str, int | str]


class Beside(Enum):
    """Which places in a bundle of a 32-bit DSP instruction and two 16-bit ones an instruction may take."""

    ALONE = frozenset[int]()
    DSP = frozenset({0})
    FIRST = frozenset({1})
    EITHER = frozenset({1, 2})


@dataclass(frozen=True, slots=True)
class Form:
    """One form of instruction.

    `does`: the name of its semantics, a function of `bfsim.blackfin.instructions.semantics` whose parameters are the letters of `bits` and the
    names in `given`. `bits`: the encoding, most significant bit first, in halfwords as they follow each other in memory: "0" and
    "1" must be so, "-" may be either, letters are operand fields; the bits of a letter may be apart; spaces are for the eye.
    `text`: the assembler text as GNU objdump prints it; `{d:R}` is the operand of field d, whose kind is R (`operands.KINDS`); a
    letter without a kind is the number that its bits make. `given`: what the semantics must know and the encoding does not say.
    `beside`: its places in a bundle. `only`: what must hold of the operands, which are its arguments by their letters. `unprinted`: operands
    with their kinds, as in a text, that the text does not have.
    """

    does: str
    bits: str
    text: str
    given: Given = field(default_factory=dict)
    beside: Beside = Beside.ALONE
    only: Callable[..., bool] | None = None
    unprinted: str = ""
    length: int = field(init=False)
    """In bytes."""
    mask: int = field(init=False)
    match: int = field(init=False)
    """An encoding is of this form if its bits in `mask` are those of `match`."""
    fields: Mapping[str, tuple[int, ...]] = field(init=False)
    """The places of each letter's bits, most significant first; place 0 is the least significant of the encoding."""
    kinds: Mapping[str, OperandKind] = field(init=False)

    def __post_init__(self) -> None:
        bits = self.bits.replace(" ", "")
        assert len(bits) in {16, 32}, self
        places: dict[str, tuple[int, ...]] = {}
        for place, bit in zip(range(len(bits) - 1, -1, -1), bits, strict=True):
            if bit.isalpha():
                places[bit] = (*places.get(bit, ()), place)
        set_ = object.__setattr__
        set_(self, "length", len(bits) // 8)
        set_(self, "mask", int("".join("1" if bit in "01" else "0" for bit in bits), 2))
        set_(self, "match", int("".join("1" if bit == "1" else "0" for bit in bits), 2))
        set_(self, "fields", places)
        named = dict(_kinds(self.text + self.unprinted))
        assert named.keys() <= places.keys(), f"{self.text}: the text names a field that the bits do not have"
        set_(self, "kinds", {letter: named.get(letter, NUMBER) for letter in places})

    def operands(self, encoding: int, address: int) -> dict[str, Operand] | None:
        """Return the operands of an encoding that has the fixed bits of this form, or None if they cannot be."""
        if encoding & self.mask != self.match:
            return None
        found = {}
        for letter, places in self.fields.items():
            raw = 0
            for place in places:
                raw = raw << 1 | encoding >> place & 1
            value = self.kinds[letter].value(raw, address)
            if value is None:
                return None
            found[letter] = value
        return found if self.only is None or self.only(**found) else None


def _kinds(text: str) -> Iterator[tuple[str, OperandKind]]:
    for _, letter, kind, _ in Formatter().parse(text):
        if letter and kind:
            yield letter, KINDS[kind]
