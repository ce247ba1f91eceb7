"""Compiled Python: what looks at every access to a memory or at every word on a bus, through numba.

Numba makes LLVM IR of it; the machine code is made, kept and loaded as that of kernels. Its name in the cache is a digest of
all sources that hold such parts: a change in one file never meets code that was compiled against another one. Numba takes its
time already to be imported, so it is imported only to compile.
"""

from __future__ import annotations

import hashlib
import importlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

import llvmlite.binding as llvm

from bfsim import machine_code, store
from bfsim.kernel.keys import tools

Function = TypeVar("Function", bound=Callable[..., Any])

ROOMS = ("kernel", "machine")
"""Folders of bfsim with compiled parts; those of one use numbers and functions of the other."""
OPTIONS = {"error_model": "numpy"}
SETTINGS = {"BOUNDSCHECK": 0, "DISABLE_JIT": 0}
"""What a user's environment may tell numba for code of its own: `words_at` does not know the length that would be checked."""

_parts: list[Callable[..., Any]] = []
"""What numba has still to be told of."""


def native(function: Function) -> Function:
    """Let `function` be compiled as a part of those that call it. Called from Python, it is plain Python."""
    _parts.append(function)
    return function


def words_at(address: Any) -> Any:
    """Return the array at an address that an entry was given. In plain Python it is given the array itself."""
    return address


@dataclass(frozen=True)
class NativeEntry:
    """A function that machine code can call: as it was written, and numba's names for the types of its result and arguments."""

    python: Callable[..., Any]
    result: str
    arguments: tuple[str, ...]

    @property
    def symbol(self) -> str:
        """Its name in the machine code."""
        return f"bfsim_{self.python.__name__}"

    def address(self) -> int:
        """Return the host address of its machine code, which is compiled or taken from the cache; once per process."""
        return _loaded(self)

    def is_kept(self) -> bool:
        """Return whether the cache has its machine code."""
        return store.load(_key(self.symbol)) is not None

    def compile(self) -> bytes:
        """Compile it, and keep it in the cache; return the object file."""
        code = machine_code.host_code(_ir(self))
        store.save(_key(self.symbol), code)
        return code


def native_entry(result: str, *arguments: str) -> Callable[[Callable[..., Any]], NativeEntry]:
    """Make a function an entry; types are those of numba, pointers with a star: "int64*"."""
    return lambda function: NativeEntry(function, result, arguments)


@cache
def _loaded(each: NativeEntry) -> int:
    code = store.load(_key(each.symbol)) or each.compile()
    machine_code.add(code)
    return machine_code.address_of(each.symbol)


@cache
def _key(symbol: str) -> str:
    package = Path(__file__).parent.parent
    digest = hashlib.sha256(f"{symbol} {version('numba')} {tools()}".encode())
    for path in sorted(path for room in ROOMS for path in (package / room).rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _ir(each: NativeEntry) -> str:
    """Return a module of LLVM IR with an entry and all that it calls, of which only the entry can be called from outside."""
    numba: Any = importlib.import_module("numba")  # its own types do not know all of its options
    for name, value in SETTINGS.items():
        setattr(numba.config, name, value)
    while _parts:
        numba.extending.register_jitable(no_cfunc_wrapper=True, **OPTIONS)(_parts.pop())
    _extend(numba)
    kinds = [_kind(numba.types, name) for name in each.arguments]
    made = numba.cfunc(_kind(numba.types, each.result)(*kinds), **OPTIONS)(each.python)
    module = llvm.parse_assembly(made.inspect_llvm())
    for function in module.functions:
        if function.name.startswith("cfunc."):
            function.name = each.symbol
        elif not function.is_declaration:
            function.linkage = "internal"  # LLVM then sees that nothing in it can fail, and leaves out what Python would do then
    return str(module)


@cache
def _extend(numba: Any) -> None:
    """Tell numba of `words_at`: nothing asks for the length, which is not known."""
    numba.extending.overload(words_at)(lambda address: lambda address: numba.carray(address, 1))


def _kind(types: Any, name: str) -> Any:
    """Return numba's type of that name."""
    return types.CPointer(_kind(types, name[:-1])) if name.endswith("*") else getattr(types, name)
