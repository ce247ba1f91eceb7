"""Checks that Python declares a function in C as C does: with other arguments it would compute anything."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress

from bfsim.blackfin.elf.image import Image
from bfsim.blackfin.elf.prototypes import CPrototype, CType, prototype_of
from bfsim.errors import KernelError
from bfsim.files import store
from bfsim.kernel import keys
from bfsim.kernel.language.function import Parameter
from bfsim.kernel.types import ArrayType, FloatType, IntType, Number

REGISTER_BYTES = 4
ONE_REGISTER = "a number of at most 32 bits or a pointer in C"


def require_declared(
    image: Image, place: str, name: str, parameters: Sequence[Parameter], result: Number | None
) -> None:
    """Raise KernelError unless parameters and result are as in C, as far as the debugging information tells.

    A number of fewer than 32 bits must be one in Python, too: GCC leaves it to the caller to truncate arguments and to
    extend results. For a pointer to a struct or to void in C, an array may be of any numbers; a pointer may be the
    number 0, and a result may be ignored. What takes more than one register in C, a number of 64 bits or a struct
    itself, cannot be declared.
    """
    key = keys.object_key(image.digest, name, "", f"told apart from {tuple(parameters)} {result}")
    wrong, prototype = store.kept(key, lambda: _otherwise(image, name, parameters, result))
    if wrong:
        raise KernelError(f"{wrong}; in {place} it is `{prototype}`")


def _otherwise(
    image: Image, name: str, parameters: Sequence[Parameter], result: Number | None
) -> tuple[str, str]:
    """Return what is declared otherwise, and C's prototype; '' if nothing is, or if its information cannot be read."""
    prototype = None
    with suppress(KernelError):
        prototype = prototype_of(image, name)
    wrong = next(_differences(prototype, parameters, result), None) if prototype else None
    return wrong or "", str(prototype or "")


def _differences(c: CPrototype, parameters: Sequence[Parameter], result: Number | None) -> Iterator[str]:
    for (name, kind), declared in zip(c.parameters, parameters, strict=False):
        called = declared.name if declared.name == name else f"{declared.name} ({name} in C)"
        if not _is_one_register(kind):
            yield f"{called} of {c.name} must be {ONE_REGISTER}, not {kind.text}"
        must_be = _what_fits(kind, declared.type)
        if must_be:
            yield f"{called} of {c.name} must be {must_be}, not {declared.type}"
    if len(c.parameters) != len(parameters):
        told = ", ".join(each.name for each in parameters) or "none"
        yield f"{c.name} must be declared with {_counted(len(c.parameters))}, not {len(parameters)} ({told})"
    if result is not None and c.result is None:
        yield f"{c.name} must have no `result`, for it returns nothing"
    elif result is not None and c.result is not None and not _is_one_register(c.result):
        yield f"the result of {c.name} must be {ONE_REGISTER}, not {c.result.text}"
    elif result is not None and c.result is not None and isinstance(result, FloatType) != c.result.is_float:
        yield f"the result of {c.name} must be {'f32' if c.result.is_float else 'an integer'}, not {result}"
    elif result is not None and c.result is not None and (short := _short(c.result)) not in (None, result):
        yield f"the result of {c.name} must be {short}, not {result}"


def _is_one_register(kind: CType) -> bool:
    return kind.target is not None or 0 < kind.nbytes <= REGISTER_BYTES


def _counted(count: int) -> str:
    return "1 parameter" if count == 1 else f"{count or 'no'} parameters"


def _what_fits(kind: CType, declared: Number | ArrayType) -> str:
    """Return what a parameter of this type in C must be; '' if what is declared will do."""
    if isinstance(declared, ArrayType):
        if kind.target is None:
            return "a number" if kind.nbytes else ""
        return _elements_that_fit(kind.target, declared)
    if kind.target is None and kind.nbytes and isinstance(declared, FloatType) != kind.is_float:
        return "f32" if kind.is_float else "an integer"
    short = _short(kind)
    if short and isinstance(declared, IntType) and not _is_within(declared, short):
        return str(short)
    return ""


def _short(kind: CType) -> IntType | None:
    """Return the type of an integer in C of fewer than 32 bits, or None for anything else."""
    if kind.target is not None or kind.is_float or not 0 < kind.nbytes < REGISTER_BYTES:
        return None
    return IntType(f"{'i' if kind.is_signed else 'u'}{8 * kind.nbytes}", 8 * kind.nbytes, kind.is_signed)


def _is_within(one: IntType, other: IntType) -> bool:
    """Whether all values of one type fit into another one."""
    (low, high), (lowest, highest) = one.bounds, other.bounds
    return lowest <= low and high <= highest


def _elements_that_fit(target: CType, declared: ArrayType) -> str:
    element = declared.element
    is_same = element.nbytes == target.nbytes and isinstance(element, FloatType) == target.is_float
    if is_same or target.target is not None or not target.nbytes:
        return ""
    return f"an array of {8 * target.nbytes}-bit {'floats' if target.is_float else 'integers'}"
