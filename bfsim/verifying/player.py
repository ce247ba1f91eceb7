"""The C program that plays recorded calls of kernels, counts their cycles and sums up what they leave.

Its input is a row of words: for each call the number of the kernel, then its arguments; an array is its length in
bytes, then its bytes up to the next whole word, any other argument is a word. END follows the last call. A call gets
fresh copies of its arrays. Its output is a line for each call: cycles and checksum.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Sequence
from importlib.resources import files
from pathlib import Path

import numpy as np

from bfsim.kernel.c.names import c_type
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import ArrayType, FloatType
from bfsim.verifying.sample import Argument

PLAYER, PLAYER_OPTIONS = "player.c", ("-std=gnu99", "-w", "-O2")
ENTRIES = "entries.c"
KERNELS = "_kernels"  # no kernel has this name in C
FACTOR = 16777619  # of the checksum: the sum of all words, each times a power of it
END = 0xFFFFFFFF
M32 = 0xFFFFFFFF


def write_player(
    folder: Path,
    kernels: Sequence[Function],
    entries: str,
    calls: Iterable[tuple[int, tuple[Argument, ...]]],
) -> list[str]:
    """Write the player of `kernels`, and their `calls` by kernel number; return the files to compile, `entries` among them."""
    (folder / PLAYER).write_text(player(kernels), encoding="utf-8")
    (folder / ENTRIES).write_text(entries, encoding="utf-8")
    with (folder / "calls.bin").open("wb") as stream:
        stream.writelines(played(calls))
    return [ENTRIES, PLAYER]


def entries_of(names: Sequence[str], *, declared: bool = True) -> str:
    """Return the C of a table of kernels by number, in its own file: a kernel may share a name with anything in the player.

    `names`: their names in C. `declared`: whether they must be declared here.
    """
    lines = [f"extern void {each}(void);\n" for each in names if declared]
    addresses = ", ".join(f"(void *){each}" for each in names)
    return "".join((*lines, f"void *const {KERNELS}[] = {{{addresses}}};\n"))


def player(kernels: Sequence[Function]) -> str:
    """Return the program for `kernels`, by their numbers in this order."""
    head = (
        (files(__package__) / "player.h")
        .read_text(encoding="utf-8")
        .replace("FACTOR_OF_CHECKSUM", f"{FACTOR}u")
    )
    parts = [head, f"extern void *const {KERNELS}[];\n"]
    parts += [_kernel(number, each) for number, each in enumerate(kernels)]
    table = ", ".join(f"play_{number}" for number in range(len(kernels)))
    parts.append(f"static void (*const players[])(void) = {{{table}}};\n\nPLAYER_MAIN(players)\n")
    return "\n".join(parts)


def _kernel(number: int, function: Function) -> str:
    """Return what plays a kernel: `timed_N` makes the call between two readings of the clock, `play_N` has the arguments."""
    measured = function.measured
    types, names, take, leave = [], [], [], []
    for place, each in enumerate(function.parameters):
        if isinstance(each.type, ArrayType):
            kind = f"{c_type(each.type.element)} *"
            take.append(f"uint32_t n{place}; {kind}a{place} = take_array(&n{place});")
            leave.append(f"leave_array(a{place}, n{place});")
        else:
            kind = c_type(each.type)
            value = "take_float()" if isinstance(each.type, FloatType) else f"({kind})take_word()"
            take.append(f"{kind} a{place} = {value};")
        types.append(kind)
        names.append(f"a{place}")
    lengths = [place for place, each in enumerate(function.parameters) if each.name in measured]
    given = [*names, *(f"(int32_t)(n{place} / sizeof *a{place})" for place in lengths)]
    names += [f"l{place}" for place in lengths]
    types += ["int32_t"] * len(lengths)
    parameters = "".join(f", {kind} {each}" for kind, each in zip(types, names, strict=True))
    result = c_type(function.result) if function.result else "void"
    subject = f"{result} (*)({', '.join(types) or 'void'})"
    call = f"subject({', '.join(names)});"
    kept = f"{result} value = {call}" if function.result else call
    returned = "    memcpy(result, &value, 4);\n" if function.result else ""
    arguments = ", ".join(["&result", *given])
    return f"""\
static NOT_INLINED uint32_t timed_{number}({subject.replace("(*)", "(*subject)")}, uint32_t *result{parameters})
{{
    uint32_t start, stop;
    CYCLES(start);
    {kept}
    CYCLES(stop);
{returned}    (void)result;
    return stop - start;
}}

static void play_{number}(void)
{{
    uint32_t result = 0;
    {" ".join(take)}
    uint32_t empty = timed_{number}(({subject})nothing, {arguments});
    result = 0;
    uint32_t spent = timed_{number}(({subject}){KERNELS}[{number}], {arguments}) - empty + RTS_CYCLES;
    {" ".join(leave)}
    told(spent, result);
}}
"""


def played(calls: Iterable[tuple[int, tuple[Argument, ...]]]) -> Iterator[bytes]:
    """Yield the input of the program: the number of each kernel and its arguments."""
    for number, arguments in calls:
        yield struct.pack("<I", number)
        for each in arguments:
            if isinstance(each, np.ndarray):
                yield struct.pack("<I", each.nbytes)
                yield _padded(each)
            else:
                yield _word(each)
    yield struct.pack("<I", END)


def checksum(arguments: Sequence[Argument], result: float | None) -> int:
    """Return the program's checksum of a call: of its arrays as it leaves them, then of its result."""
    octets = b"".join(_padded(each) for each in arguments if isinstance(each, np.ndarray))
    words = np.frombuffer(octets + _word(result or 0), "<u4")
    powers = np.cumprod(np.r_[1, np.full(len(words) - 1, FACTOR)].astype(np.uint32), dtype=np.uint32)
    return int(np.sum(words * powers[::-1], dtype=np.uint32))


def _word(value: float) -> bytes:
    return struct.pack("<f", value) if isinstance(value, float) else struct.pack("<I", value & M32)


def _padded(array: Argument) -> bytes:
    assert isinstance(array, np.ndarray)
    octets: bytes = array.tobytes()
    return octets + bytes(-len(octets) % 4)
