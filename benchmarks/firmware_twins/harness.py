"""The program that measures one C twin: it plays recorded calls, counts their cycles and sums up what they leave.

The arguments lie in a block of words: the number of calls, then those of each call one after the other. An array is its
length in bytes, then its bytes up to the next whole word; an integer is a word. A call gets fresh copies of its arrays.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np

from benchmarks.firmware_twins.recorded import Argument
from bfsim.api import Kernel
from bfsim.kernel import tree
from bfsim.kernel.types import ArrayType

FACTOR = 16777619  # of the checksum: the sum of all words, each times a power of it
M32 = 0xFFFFFFFF

# The cycles of a call, from its first operation to its RTS: those of the same call of a function that only returns are
# subtracted, but for its RTS. `timed` is one function, so that nothing else differs.
HEAD = """\
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define RTS_CYCLES 5
#define ROOM (1 << 18)

#ifdef __BFIN__
__asm__(".text; .global _nothing; _nothing: RTS;");
#define ENABLE() __asm__ volatile("R0=SYSCFG; BITSET(R0,1); SYSCFG=R0; CSYNC;" ::: "R0", "CC")
#define CYCLES(c) __asm__ volatile("%0 = CYCLES;" : "=d"(c) :: "memory")
extern void nothing(void);
#else
#define ENABLE() ((void)0)
#define CYCLES(c) ((c) = 0u)
static void nothing(void) {}
#endif

extern const uint32_t calls[];
static uint32_t room[ROOM];
static uint32_t *next;
static const uint32_t *from;

static void *array(void)
{
    uint32_t words = (*from++ + 3) / 4;
    uint32_t *to = next;
    memcpy(to, from, 4 * words);
    from += words;
    next += words;
    return to;
}
"""
MAIN = """
static __attribute__((noipa)) uint32_t timed({type} (*subject)({types}), uint32_t *result{parameters})
{{
    uint32_t start, stop;
    CYCLES(start);
    {assign}subject({names});
    CYCLES(stop);
    return stop - start;
}}

int main(void)
{{
    uint32_t sum = 0, count;
    ENABLE();
    from = calls;
    count = *from++;
    for (uint32_t call = 0; call < count; call++) {{
        uint32_t spent, result = 0;
        next = room;
{take}
        spent = RTS_CYCLES - timed(({type} (*)({types}))nothing, &result, {names});
        spent += timed(entry, &result, {names});
        for (uint32_t *word = room; word < next; word++)
            sum = sum * {factor}u + *word;
        sum = sum * {factor}u + result;
        printf("%lu\\n", (unsigned long)spent);
    }}
    printf("%08lx\\n", (unsigned long)sum);
    return 0;
}}
"""


def lengths(function: tree.Function) -> list[int]:
    """Return which parameters of a kernel are arrays whose length it, or a kernel it calls, asks for."""
    names = [each.name for each in function.parameters]
    return sorted(names.index(each) for each in tree.measured_arrays(function))


def driver(kernel: Kernel) -> str:
    """Return the C source of the program, but for the kernel, its helpers and `calls`."""
    function = kernel.function
    types, names, take = [], [], []
    for number, each in enumerate(function.parameters):
        is_array = isinstance(each.type, ArrayType)
        kind = f"{c_type(each.type.element)} *" if isinstance(each.type, ArrayType) else c_type(each.type)
        types.append(kind)
        names.append(f"a{number}")
        value = "array()" if is_array else "*from++"
        if number in lengths(function):
            take.append(f"n{number} = *from / sizeof *a{number};")
        take.append(f"a{number} = ({kind}){value};")
    for number in lengths(function):
        types.append("int32_t")
        names.append(f"n{number}")
    declared = [f"        {kind} {name};" for kind, name in zip(types, names, strict=True)]
    result = c_type(function.result) if function.result else "void"
    main = MAIN.format(
        take="\n".join([*declared, *(f"        {each}" for each in take)]),
        type=result,
        types=", ".join(types),
        assign="*result = (uint32_t)" if function.result else "",
        parameters="".join(f", {kind} {name}" for kind, name in zip(types, names, strict=True)),
        names=", ".join(names),
        factor=FACTOR,
    )
    return f"{HEAD}\nextern {result} (*const entry)({', '.join(types)});\n{main}"


def entry(kernel: Kernel) -> str:
    """Return the C declaration by which the program finds the kernel."""
    return f"void *const entry = (void *){kernel.name};\n"


def c_type(kind: object) -> str:
    """Return the name in C of an integer type."""
    return f"{'u' if str(kind).startswith('u') else ''}int{str(kind)[1:]}_t"


def block(calls: Sequence[tuple[Argument, ...]]) -> bytes:
    """Return the recorded calls as the program reads them."""
    parts = [struct.pack("<I", len(calls))]
    for call in calls:
        for each in call:
            if isinstance(each, np.ndarray):
                parts += [struct.pack("<I", each.nbytes), _padded(each)]
            else:
                parts.append(struct.pack("<I", each & M32))
    return b"".join(parts)


def _padded(array: Argument) -> bytes:
    assert isinstance(array, np.ndarray)
    octets: bytes = array.tobytes()
    return octets + bytes(-len(octets) % 4)


class Checksum:
    """The program's checksum: of each call its arrays as they are afterwards, and its result."""

    def __init__(self) -> None:
        self.value = 0

    def add(self, arguments: tuple[Argument, ...], result: int | None) -> None:
        """Add a call that was made."""
        octets = b"".join(_padded(each) for each in arguments if isinstance(each, np.ndarray))
        words = np.frombuffer(octets + struct.pack("<I", (result or 0) & M32), "<u4")
        powers = np.cumprod(np.r_[1, np.full(len(words), FACTOR)].astype(np.uint32), dtype=np.uint32)
        total = int(np.sum(words * powers[:-1][::-1], dtype=np.uint32))
        self.value = (self.value * int(powers[-1]) + total) & M32

    def __str__(self) -> str:
        return f"{self.value:08x}"
