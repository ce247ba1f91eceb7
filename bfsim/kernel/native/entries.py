"""Compiled Python: functions that look at every access to a memory or at every word on a bus.

Numba makes LLVM IR of them (`numba_ir`). The IR of the current sources comes with bfsim (`benchmarks/keep_native.py`
makes it), so numba is needed only after a change. Machine code is made of it, kept and loaded as for kernels. Its name
in the cache is a digest of all files with such functions, so code never meets numbers or functions of another version.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any, TypeVar

from bfsim import machine_code
from bfsim.files import store
from bfsim.files.content import digest_of, python_below
from bfsim.kernel.keys import tools

Function = TypeVar("Function", bound=Callable[..., Any])

ROOMS = ("kernel", "machine")
"""Folders of bfsim with compiled parts; one uses numbers and functions of the other."""

_parts: list[Callable[..., Any]] = []
"""Functions that entries may call."""


def native(function: Function) -> Function:
    """Let `function` be compiled as a part of those that call it. Called from Python, it is plain Python."""
    _parts.append(function)
    return function


def words_at(address: Any) -> Any:
    """Return the array at an address that an entry was given; in plain Python it is given the array itself."""
    return address


@dataclass(frozen=True)
class NativeEntry:
    """A function that machine code can call: as written, and numba's names for the types of its result and arguments."""

    python: Callable[..., Any]
    result: str
    arguments: tuple[str, ...]

    @property
    def symbol(self) -> str:
        """Its name in the machine code."""
        return f"bfsim_{self.python.__name__}"

    def address(self) -> int:
        """Return the host address of its machine code, which is compiled or taken from the cache; once per process."""
        return self._address

    @cached_property
    def _address(self) -> int:
        code = store.load(_key(self.symbol))
        if code is None:
            kept = store.shipped(__package__, self.digest())
            code = machine_code.host_code(self.ir() if kept is None else kept.decode())
            store.save(_key(self.symbol), code)
        machine_code.add(code)
        return machine_code.address_of(self.symbol)

    def digest(self) -> str:
        """Return the name under which its IR is kept: a digest of what that is made from."""
        from bfsim.kernel.native.sources import source_of  # most starts find all machine code

        made_by = Path(__file__).with_name("numba_ir.py").read_text(encoding="utf-8")
        parts = (self.symbol, self.result, *self.arguments, made_by, source_of(self.python))
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()

    def ir(self) -> str:
        """Make a module of LLVM IR with it and all that it calls."""
        from bfsim.kernel.native.numba_ir import made_ir  # as above

        return made_ir(self.python, self.symbol, (self.result, *self.arguments), _parts, words_at)


def native_entry(result: str, *arguments: str) -> Callable[[Callable[..., Any]], NativeEntry]:
    """Make a function an entry; types are those of numba, pointers with a star: "int64*"."""
    return lambda function: NativeEntry(function, result, arguments)


def _key(symbol: str) -> str:
    return hashlib.sha256(f"{symbol} {tools()} {_sources()}".encode()).hexdigest()


@cache
def _sources() -> str:
    """Return the digest of all files that hold compiled parts."""
    package = Path(__file__).parents[2]
    return digest_of(path for room in ROOMS for path in python_below(package / room))
