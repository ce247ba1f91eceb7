"""`--sanitize`: a second build of a kernel that checks every index, run and undone before the real one.

The counted build stays untouched, so a sanitized run reports the very same cycles; it only takes longer.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import cache
from typing import Any

from numpy.typing import NDArray

from bfsim.errors import KernelError
from bfsim.kernel import jit, tree
from bfsim.kernel.costs import optimised
from bfsim.kernel.emit import TRAP, TRAP_WORDS
from bfsim.kernel.instrument import instrument
from bfsim.kernel.profile import VDSP_O2
from bfsim.kernel.types import ArrayType, FloatType
from bfsim.kernel.work import BITS, FLOAT


def check(function: tree.Function, arguments: Sequence[Any]) -> None:
    """Run the checked build, then put the arrays back as they were. Raise KernelError at a bad index."""
    code, trap = _checked(function)
    before: list[tuple[NDArray[Any], NDArray[Any]]] = []
    words = [0]  # no counters, no totals
    for parameter, argument in zip(function.parameters, arguments, strict=True):
        if isinstance(parameter.type, ArrayType):
            before.append((argument, argument.copy()))
            words += [argument.ctypes.data, len(argument)]
        else:
            is_float = isinstance(parameter.type, FloatType)
            words.append(BITS.unpack(FLOAT.pack(argument))[0] if is_float else int(argument))
    block = (ctypes.c_int64 * (len(words) + 1))(*words)
    trap[0] = 0
    code.cell.value = ctypes.addressof(block)
    code.entry()
    for array, contents in before:
        if array.flags.writeable:
            array[:] = contents
    if trap[0]:
        _report(function, *trap)


def _report(function: tree.Function, line: int, number: int, position: int, index: int) -> None:
    routine = (*function.callees(), function)[number]
    array = [each.name for each in routine.parameters if isinstance(each.type, ArrayType)][position]
    text = routine.source.splitlines()[line - 1].strip()
    raise KernelError(
        f"{routine.file}:{routine.first_line + line - 1}: index {index} is outside of {array} in kernel {routine.name}; "
        f"an index must be 0 or more and less than len({array})\n    {text}"
    )


@cache
def _checked(function: tree.Function) -> tuple[jit.CompiledKernel, Any]:
    """Compile the checked build; return it and the words of its trap."""
    name = f"checked_{function.symbol}_{id(function):x}"
    text = optimised(function, VDSP_O2, checked=True).replace(f"@{TRAP}", f"@trap_{name}")
    code = jit.load(jit.host_code(instrument(text, function, (), name, traced=False)), name, ())
    return code, (ctypes.c_int64 * TRAP_WORDS).from_address(jit.address_of(f"trap_{name}"))
