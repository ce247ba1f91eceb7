"""`@kernel`: a Python function that is compiled for the host, run on real pixels, and costed as Blackfin code."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cached_property, wraps
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import BfsimWarning, KernelError
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.kernel.calls.arguments import Arguments
from bfsim.kernel.calls.outside import refuse_in_firmware
from bfsim.kernel.calls.work import Work
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.estimate.estimated import costs_of
from bfsim.kernel.host_code.jit import CompiledKernel, compile_kernel
from bfsim.kernel.host_code.prepared_call import PreparedCall
from bfsim.kernel.language.function import Function
from bfsim.kernel.language.reading import read_kernel
from bfsim.kernel.profile import DEFAULT, GCC_O0, RUN_AS_COMPILED, CompilerProfile, profile_named
from bfsim.machine_code import Effort
from bfsim.machine_code.endless import ended_by_signals

if TYPE_CHECKING:
    from bfsim.kernel.objects.compiled import CompiledObject
    from bfsim.kernel.objects.loaded_files import LoadedFiles

AS_WRITTEN = GCC_O0
"""A profile that leaves every access and division in the code."""
_IN_PYTHON = ContextVar("_IN_PYTHON", default=False)
"""Whether a kernel is running as plain Python."""


class ObjectCode(Protocol):
    """The object code of a kernel that is not written in Python.

    `files`: what it was made from, with their SHA-256. `compiler`: what compiled it; empty if the file is object code.
    `name`: of the file. `data_bytes`: the size of all its variables and tables.
    """

    @property
    def files(self) -> Mapping[Path, str]: ...

    @property
    def name(self) -> str: ...

    @property
    def data_bytes(self) -> int: ...

    @property
    def compiler(self) -> str: ...

    def compiled(
        self, profile: CompilerProfile, *, traced: bool = False, files: LoadedFiles | None = None
    ) -> CompiledObject:
        """Return it ready to run, with the timing of `profile`; `traced`: it reports its accesses to memory.

        `files`: what its core has loaded, if it runs on one.
        """


class RunnableCall(Protocol):
    """A kernel bound to its arrays, ready to run."""

    @property
    def stays_in_l1(self) -> bool:
        """Whether all its accesses stay in L1."""

    def run(self, *arguments: Any) -> Work:
        """Run the kernel now and return its cost. Only the numbers among `arguments` are read."""


@dataclass(frozen=True, eq=False, repr=False)
class Kernel:
    """A kernel. Calling it runs the compiled code on numpy arrays; `cost` returns the cycles of a call.

    `definition` is the function as it was written. A kernel of another language has `object_code` instead, which runs
    as it is; the profile says how it is timed. `own_code` finds the code that a profile's compiler makes of a kernel in
    Python.
    """

    function: Function
    definition: Callable[..., Any] | None
    object_code: ObjectCode | None = None
    own_code: Callable[[Kernel, CompilerProfile], CompiledObject | None] | None = None

    @cached_property
    def python(self) -> Callable[..., Any] | None:
        """The function as plain Python, with the kernels that it calls. Use lists and ints: elements of numpy arrays wrap at their own width."""
        definition = self.definition
        if definition is None:
            return None

        @wraps(definition)
        def plain(*arguments: Any) -> Any:
            before = _IN_PYTHON.set(True)
            try:
                return definition(*arguments)
            finally:
                _IN_PYTHON.reset(before)

        return plain

    def __repr__(self) -> str:
        """Return name and place, not all of the object code."""
        return f"<kernel {self.name} ({self.place})>"

    @property
    def name(self) -> str:
        """Name of the function."""
        return self.function.name

    @property
    def place(self) -> str:
        """Where it is defined, as file:line."""
        return self.function.place

    @cached_property
    def arguments(self) -> Arguments:
        """What a call must be given."""
        return Arguments(self.function)

    @property
    def array_positions(self) -> tuple[int, ...]:
        """Which parameters are arrays."""
        return self.arguments.array_positions

    def compile(
        self,
        profile: CompilerProfile,
        *,
        traced: bool = False,
        counted: bool = True,
        checked: bool = True,
        effort: Effort = Effort.ALL,
        files: LoadedFiles | None = None,
    ) -> CompiledKernel | CompiledObject:
        """Compile for `profile`, or take it from the cache on disk; see `jit.compile_kernel` and `ObjectCode.compiled`.

        Raises KernelError if the kernel has floats and the profile has no library for them.
        """
        if self.object_code:
            return self.object_code.compiled(profile, traced=traced, files=files)
        self._refuse_floats(profile)
        return compile_kernel(
            self.function, profile, traced=traced, counted=counted, checked=checked, effort=effort
        )

    def counters(self, profile: CompilerProfile) -> tuple[Counter, ...]:
        """Return the counters of a run and what each costs, callees included. Raises KernelError as `compile` does."""
        if self.object_code:
            return self.object_code.compiled(profile).program.costs.counters
        self._refuse_floats(profile)
        return costs_of(self.function, profile).counters

    def code_bytes(self, profile: CompilerProfile) -> dict[str, int]:
        """Return the size of the kernel's code, and of each kernel that it calls, by the names in the machine code."""
        nbytes: dict[str, int] = {}
        for each in self.counters(profile):
            nbytes[each.routine] = nbytes.get(each.routine, 0) + each.nbytes
        return nbytes

    def prepare(
        self,
        code: CompiledKernel | CompiledObject,
        arrays: Sequence[NDArray[Any]],
        totals: NDArray[np.int64],
        access_trace: AccessTrace | None = None,
        first_site: int = 0,
        stack: NDArray[np.uint8] | None = None,
        memory: NDArray[np.uint8] | None = None,
    ) -> RunnableCall:
        """Bind `arrays`, in the order of the array parameters. Raises KernelError if one does not fit its type.

        `first_site`: the number of the program's first site in the access trace. `stack`: memory whose accesses object
        code reports, too. `memory`: the board's; object code uses arrays that lie in it without copying them.
        """
        for position, array in zip(self.array_positions, arrays, strict=True):
            self.arguments.check_array(position, array)
        if not isinstance(code, CompiledKernel):
            from bfsim.kernel.objects.calls import ObjectCall  # most firmware is Python

            return ObjectCall(
                code, arrays, self.arguments.check, totals, access_trace, first_site, stack, memory
            )
        self.arguments.check_overlaps(arrays)
        return PreparedCall(
            self.function, code, arrays, self.arguments.check, totals, access_trace, first_site
        )

    def _refuse_floats(self, profile: CompilerProfile) -> None:
        if profile.floats is not None:
            return
        from bfsim.kernel.language.tree import first_float  # the body must be read, which few runs need

        for each in (self.function, *self.function.callees()):
            line = first_float(each)
            if line is not None:
                place = f"{each.file}:{each.first_line + line - 1}"
                shown = each.lines[line - 1]
                raise KernelError(
                    f"{place}: {each.name} must do without floats, for the profile {profile.name} has no library for "
                    f"them; use fixed point, or another profile\n    {shown}"
                )

    @cached_property
    def arrays_of(self) -> Callable[[Sequence[Any]], Any]:
        """Picks the array arguments out of all: a tuple, or the argument itself if there is only one."""
        return itemgetter(*self.array_positions) if self.array_positions else lambda _arguments: ()

    def sanitize(self, arguments: Sequence[Any]) -> None:
        """Run the kernel as written, and undo its stores (`sanitizer`)."""
        self.sanitizer([arguments[each] for each in self.array_positions])(arguments)

    def sanitizer(self, arrays: Sequence[NDArray[Any]]) -> Callable[[Sequence[Any]], None]:
        """Return a function that runs the kernel as written, with every index and divisor checked, and undoes its stores.

        It runs unoptimised, on `arrays`. It takes the arguments of a call, reads only the numbers, and raises
        KernelError at the first wrong index or divisor, even one that the compiler would leave out. In object code
        nothing is checked.
        """
        if self.object_code:
            return lambda _arguments: None
        code = compile_kernel(self.function, AS_WRITTEN, counted=False, effort=Effort.REGISTERS)
        run = self.prepare(code, arrays, code.new_totals()).run
        named = zip(self.function.array_names, arrays, strict=True)
        stored = [array for name, array in named if name in self.function.written and array.flags.writeable]

        def sanitize(arguments: Sequence[Any]) -> None:
            before = [each.copy() for each in stored]
            try:
                run(*arguments)
            finally:
                for array, contents in zip(stored, before, strict=True):
                    array[:] = contents

        return sanitize

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Run on numpy arrays and ints, as firmware would, but without a machine around it.

        Returns what the kernel returns; arrays that it stores into are changed. Raises KernelError for arguments that do
        not fit, and FirmwareError in a main loop.
        """
        if named:
            names = ", ".join(each.name for each in self.function.parameters)
            raise KernelError(
                f"{self.name} must get {names} by their places, not {', '.join(named)} by name ({self.place})"
            )
        if _IN_PYTHON.get() and self.definition:
            return self.definition(*arguments)
        refuse_in_firmware(self.name)
        self.arguments.check(arguments)
        return self._run(arguments, self.compile(DEFAULT)).value

    def cost(self, *arguments: Any, profile: str = DEFAULT.name) -> int:
        """Run as a call does, and return its CCLK cycles: operations and their interlocks, callees included.

        A call takes these with code and arrays in L1, without waits for memory: for unit tests. `profile` names the
        compiler; with `gcc` and `gcc-adi` it is the cost of the code that GCC makes of the kernel, or an estimate, with
        a warning, if there is none. Raises KernelError for arguments that do not fit, and ConfigError with GCC's
        message if GCC refuses the kernel.
        """
        self.arguments.check(arguments)
        compiler = profile_named(profile)
        work = self._run(arguments, self._own(compiler) or self.compile(compiler))
        return work.issue_cclk + work.stall_cclk

    def _run(self, arguments: Sequence[Any], code: CompiledKernel | CompiledObject) -> Work:
        arrays = [arguments[each] for each in self.array_positions]
        call = self.prepare(code, arrays, code.new_totals())
        with ended_by_signals():
            return call.run(*arguments)

    def _own(self, profile: CompilerProfile) -> CompiledObject | None:
        """Return the code that a profile's compiler makes of it, if the profile runs that code."""
        if self.object_code or profile.name not in RUN_AS_COMPILED:
            return None
        code = self.own_code(self, profile) if self.own_code else None
        if code is None:
            why = (
                "no code of GCC is kept for it, and GCC is not on the PATH"
                if self.own_code
                else "only what `kernel` of bfsim.api makes of it has code of GCC, not `kernel` of bfsim.kernel"
            )
            warnings.warn(
                f"the cost of {self.name} in {profile.name} is an estimate: {why} ({self.place})",
                BfsimWarning,
                stacklevel=3,
            )
        return code


def kernel(python: Callable[..., Any] | None = None, /, **options: object) -> Kernel:
    """Make `python` a kernel. Raises KernelError, with file, line and caret, if it leaves the language.

    There are no options: anything in brackets is refused.
    """
    if python is None or options:
        raise KernelError(
            f"@kernel must stand without brackets, not as @kernel({', '.join(options)}): how it is compiled is for "
            "the profile to say (--profile)"
        )
    return Kernel(read_kernel(python), python)
