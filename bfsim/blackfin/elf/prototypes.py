"""What C says of a function: its parameters and its result, according to DWARF."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from bfsim.blackfin.elf.image import Image
from bfsim.blackfin.elf.units import Unit, read_units

TRANSPARENT = {
    "DW_TAG_typedef": "",
    "DW_TAG_const_type": "const ",
    "DW_TAG_volatile_type": "volatile ",
    "DW_TAG_restrict_type": "",
}
"""What a type may be wrapped in: a name for it, or a qualifier, which changes neither size nor kind."""

NUMBERS = {"base", "enumeration"}
PREFIXES = {"structure": "struct", "union": "union", "enumeration": "enum"}
"""What C writes before the name of a type of one of these kinds."""

FLOAT, SIGNED = 4, (5, 6)
"""[DWARF 5, table 7.11] DW_ATE_float; DW_ATE_signed and DW_ATE_signed_char."""


@dataclass(frozen=True, slots=True)
class CType:
    """A type: its text in C, its bytes, and what a pointer points to. Bytes are 0 unless it is a number or a pointer."""

    text: str
    nbytes: int
    is_float: bool = False
    is_signed: bool = False
    target: CType | None = None


@dataclass(frozen=True, slots=True)
class CPrototype:
    """The parameters of a function by their names, in order, and what it returns; None for nothing."""

    name: str
    parameters: tuple[tuple[str, CType], ...]
    result: CType | None

    def __str__(self) -> str:
        listed = ", ".join(f"{kind.text} {name}".replace("* ", "*") for name, kind in self.parameters)
        return f"{self.result.text if self.result else 'void'} {self.name}({listed or 'void'})"


def prototype_of(image: Image, name: str) -> CPrototype | None:
    """Return the prototype of the function that C calls `name`.

    None for code without debugging information, and for a function that takes any number of arguments. Raises
    KernelError if the debugging information is damaged.
    """

    def read(unit: Unit) -> Iterator[CPrototype]:
        for entry in unit.unit.iter_DIEs():
            if entry.tag == "DW_TAG_subprogram" and _name(entry) == name and _is_told(entry):
                yield _prototype(entry, name)

    return next(iter(read_units(image, read)), None)


def _is_told(entry: Any) -> bool:
    """Whether an entry is the function itself with all of its parameters: -g1 leaves them out, and so may C before C23."""
    tags = {each.tag for each in entry.iter_children()}
    is_whole = "DW_AT_prototyped" in entry.attributes or "DW_TAG_formal_parameter" in tags
    return (
        is_whole
        and "DW_AT_declaration" not in entry.attributes
        and "DW_TAG_unspecified_parameters" not in tags
    )


def _prototype(entry: Any, name: str) -> CPrototype:
    parameters = [each for each in entry.iter_children() if each.tag == "DW_TAG_formal_parameter"]
    return CPrototype(name, tuple((_name(each), _type_of(each)) for each in parameters), _result(entry))


def _result(entry: Any) -> CType | None:
    return _type_of(entry) if "DW_AT_type" in entry.attributes else None


def _name(entry: Any) -> str:
    found = entry.attributes.get("DW_AT_name")
    return found.value.decode(errors="replace") if found else ""


def _type_of(entry: Any) -> CType:
    """Return the type that an entry refers to; `void` if it names none."""
    qualifiers, kind = "", entry
    while "DW_AT_type" in kind.attributes:
        kind = kind.get_DIE_from_attribute("DW_AT_type")
        if kind.tag not in TRANSPARENT:
            return _plain(kind, qualifiers)
        qualifiers += TRANSPARENT[kind.tag]
    return CType(f"{qualifiers}void", 0)


def _plain(entry: Any, qualifiers: str) -> CType:
    if entry.tag == "DW_TAG_pointer_type":
        target = _type_of(entry)
        return CType(f"{target.text} *{qualifiers}".rstrip(), 4, target=target)
    values = {name: each.value for name, each in entry.attributes.items()}
    kind = entry.tag.removeprefix("DW_TAG_").removesuffix("_type")
    words = [
        qualifiers.strip(),
        PREFIXES.get(kind, ""),
        _name(entry) or (kind if kind not in PREFIXES else ""),
    ]
    nbytes = values["DW_AT_byte_size"] if kind in NUMBERS else 0
    encoding = values.get("DW_AT_encoding")
    return CType(" ".join(filter(None, words)), nbytes, encoding == FLOAT, encoding in SIGNED)
