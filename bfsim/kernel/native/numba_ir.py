"""Compiled Python → LLVM IR, through numba: optimised, and for no host in particular, so that it can come with bfsim.

Numba takes its time already to be imported, so it is imported only to compile.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import llvmlite.binding as llvm

from bfsim.errors import BfsimError

OPTIONS = {"error_model": "numpy"}
SETTINGS = {"DISABLE_JIT": 0}
"""Whatever a user's environment tells numba for code of its own. Numba optimises for the host; what it would do is done here."""
ROUNDS = 2
"""Of LLVM's passes. In the second one they see that nothing can fail, and leave out what Python would do then."""

Function = Callable[..., Any]


def made_ir(
    entry: Function,
    symbol: str,
    kinds: tuple[str, ...],
    parts: Iterable[Function],
    words_at: Function,
) -> str:
    """Return a module of LLVM IR with an entry called `symbol` and all that it calls, of which only the entry has a name.

    `kinds`: the types of its result and arguments. `parts`: what it may call; of `words_at`, nothing asks for a length.
    """
    numba = _numba()
    with _settings(numba.config):
        for each in parts:
            _register(each)
        _extend(words_at)
        result, *arguments = (_kind(numba.types, name) for name in kinds)
        made = numba.cfunc(result(*arguments), **OPTIONS)(entry)
        module = llvm.parse_assembly(_inlined(made.inspect_llvm()))
    for each in (*module.functions, *module.global_variables):
        if each.name.startswith("cfunc."):
            each.name = symbol
        elif not each.is_declaration:
            each.linkage = "internal"
    _optimise(module)
    module.triple = module.data_layout = module.name = ""
    return str(module)


def _inlined(text: str) -> str:
    """Return a module whose entry is the function itself, where numba has it call that: some functions are called at every access."""
    return text.replace("noinline", "alwaysinline")


def _optimise(module: llvm.ModuleRef) -> None:
    """Optimise for any processor."""
    llvm.initialize_native_target()
    machine = llvm.Target.from_triple(module.triple).create_target_machine()
    options = llvm.create_pipeline_tuning_options()
    options.loop_vectorization = options.slp_vectorization = options.loop_unrolling = False
    builder = llvm.create_pass_builder(machine, options)
    for _ in range(ROUNDS):
        builder.getModulePassManager().run(module, builder)
    last = llvm.create_new_module_pass_manager()
    last.add_strip_symbols_pass()
    last.run(module, builder)


def _numba() -> Any:
    """Return numba, whose own types do not know all of its options. Raises BfsimError where there is none."""
    try:
        return importlib.import_module("numba")
    except ImportError as error:
        raise BfsimError(
            "numba must be installed where bfsim's own compiled functions are not those that it came with, but is not: "
            "pip install numba"
        ) from error


@contextmanager
def _settings(config: Any) -> Iterator[None]:
    """Have numba as `SETTINGS` say in the context."""
    settings = {**SETTINGS, "OPT": type(config.OPT)(0)}
    before = {name: getattr(config, name) for name in settings}
    try:
        for name, value in settings.items():
            setattr(config, name, value)
        yield
    finally:
        for name, value in before.items():
            setattr(config, name, value)


@cache
def _register(part: Function) -> None:
    """Tell numba of a function that others call."""
    _numba().extending.register_jitable(no_cfunc_wrapper=True, **OPTIONS)(part)


@cache
def _extend(words_at: Function) -> None:
    """Tell numba of `words_at`: an address is taken for an array, none of whose indices is negative."""
    numba = _numba()
    numba.extending.overload(words_at)(lambda address: lambda address: address)


def _kind(types: Any, name: str) -> Any:
    """Return numba's type of that name."""
    return types.CPointer(_kind(types, name[:-1])) if name.endswith("*") else getattr(types, name)
