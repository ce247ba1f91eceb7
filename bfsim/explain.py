"""One kernel, line by line: the operations that stand for it, what each execution costs, and how often it ran.

It does for kernels what llvm-mca and uiCA do for machine code: it answers "why does this line cost so much?"
"""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Iterable, Sequence
from dataclasses import replace

from bfsim.errors import ConfigError
from bfsim.kernel import CompilerProfile, Kernel
from bfsim.kernel.build import Build
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.estimate.inlining.inlining import decisions
from bfsim.kernel.language.function import Function
from bfsim.kernel.operations import MNEMONICS, Op
from bfsim.loading.firmware import load_firmware
from bfsim.loading.hardware import find_profile
from bfsim.loading.kernel_named import load_kernel
from bfsim.running.building import build_for
from bfsim.trace import KernelRecord, RunRecord, StallReason
from bfsim.trace.explanation import (  # fmt: skip
    ExplainedCall,
    ExplainedLine,
    ExplainedOperation,
    Explanation,
    InlinedKernel,
)

BRANCHES = {Op.BRANCH_TAKEN, Op.BRANCH_NOT_TAKEN, Op.BRANCH_TAKEN_BP, Op.BRANCH_NOT_TAKEN_BP}

OBJECT_CODE = "as compiled"
"""Shown in place of a profile for kernels that are not in Python."""


def explain_named(name: str, firmware: str, profile: str, run: RunRecord | None = None) -> Explanation:
    """Explain the kernel `name`: FILE.py:NAME, PACKAGE:NAME or the name of a kernel of `firmware`; see `explain`."""
    kernel, build = (
        load_kernel(name, firmware),
        build_for(load_firmware(firmware), find_profile(profile).value),
    )
    return _explained(kernel, build, run.kernels if run else None)


def explain(
    kernel: Kernel, profile: CompilerProfile, records: Sequence[KernelRecord] | None = None
) -> Explanation:
    """Explain `kernel` as `profile` compiles it; `records` of a run tell how often each line ran and what it cost.

    Raises ConfigError when the kernel did not run, and KernelError when the profile refuses it.
    """
    return _explained(kernel, Build(profile), records)


def _explained(kernel: Kernel, build: Build, records: Sequence[KernelRecord] | None) -> Explanation:
    function = kernel.function
    is_object = build.has_code(kernel)
    counters = [each for each in build.counters(kernel) if each.routine == function.symbol]
    mine = None if records is None else _of_kernel(function, records)
    used = {each.line.routine for counter in counters for each in counter.charges}
    return Explanation(
        kernel=function.name,
        file=function.file,
        first_line=function.first_line,
        profile=OBJECT_CODE if kernel.object_code else build.code if is_object else build.profile.name,
        code_bytes=sum(each.nbytes for each in counters),
        calls=None if mine is None else sum(each.calls for each in mine),
        lines=_lines(function, counters, mine),
        kernel_calls=() if is_object else _kernel_calls(function, build.profile),
        inlined=tuple(
            InlinedKernel(kernel=each.name, file=each.file, lines=_lines(each, counters, None))
            for each in function.callees()
            if each.symbol in used
        ),
    )


def _kernel_calls(function: Function, profile: CompilerProfile) -> tuple[ExplainedCall, ...]:
    """Return the calls of `function`, including those in kernels that are inlined into it, and what becomes of each."""
    kernels = {each.symbol: each for each in (*function.callees(), function)}
    found, waiting = [], [function.symbol]
    every = decisions(function, profile)
    while waiting:
        caller = kernels[waiting.pop(0)]
        for each in (each for each in every if each.caller == caller.symbol):
            callee = kernels[each.callee]
            row = ExplainedCall(
                caller=caller.name,
                file=caller.file,
                line=caller.first_line + each.line - 1,
                callee=callee.name,
                inlined=each.inlined,
                why=each.why.value,
                growth=each.growth,
            )
            if row not in found:
                found.append(row)
                waiting += [callee.symbol] * each.inlined
    return tuple(found)


def _lines(
    function: Function, counters: Sequence[Counter], records: Sequence[KernelRecord] | None
) -> tuple[ExplainedLine, ...]:
    """Return the lines of a kernel, each with its share of `counters`."""
    own = [
        replace(each, charges=tuple(one for one in each.charges if one.line.routine == function.symbol))
        for each in counters
    ]
    used = {one.line.line for each in own for one in each.charges}
    return tuple(
        row
        for line, text in enumerate(function.lines, start=1)
        for row in _line(function, line, text, own if line in used else (), records)
    )


def _of_kernel(function: Function, records: Sequence[KernelRecord]) -> list[KernelRecord]:
    place = (function.name, function.file, function.first_line)
    found = [each for each in records if (each.kernel, each.file, each.first_line) == place]
    if not found:
        raise ConfigError(
            f"{function.name} must have run to be counted, but did not; `bfsim profile` lists the kernels that do"
        )
    return found


def _line(
    function: Function,
    line: int,
    text: str,
    counters: Sequence[Counter],
    records: Sequence[KernelRecord] | None,
) -> Iterable[ExplainedLine]:
    """Yield a row for each loop depth at which a line has operations: entering a loop happens once, its turns often."""
    depths = sorted(
        {each.depth for each in counters if any(charge.line.line == line for charge in each.charges)}
    )
    number = function.first_line + line - 1
    for row, depth in enumerate(depths or [0]):
        here = [each for each in counters if each.depth == depth]
        always, sides = _cycles(line, here)
        costs = [cost for each in records or () for cost in each.lines if cost.line == number]
        last = row == len(depths or [0]) - 1
        counted = records is not None and last
        yield ExplainedLine(
            line=number,
            text=text if row == 0 else "",
            depth=depth,
            operations=_operations(line, here),
            least_cclk=always + sum(min(0, side) for side in sides),
            most_cclk=always + sum(max(0, side) for side in sides),
            stall_cclk=sum(
                each.times * each.stall_cclk
                for counter in here
                for each in counter.charges
                if each.line.line == line
            ),
            executions=sum(cost.executions for cost in costs) if counted else None,
            total_cclk=sum(cost.issue_cclk + cost.stall_cclk.get(StallReason.INTERLOCK, 0) for cost in costs)
            if counted
            else None,
        )


def _cycles(line: int, counters: Sequence[Counter]) -> tuple[int, list[int]]:
    """Return the cycles of a line when every test is false, and what each test adds when it is true."""
    always, sides = 0, []
    for each in counters:
        cclk = sum(
            one.times * (one.issue_cclk + one.stall_cclk) for one in each.charges if one.line.line == line
        )
        if each.value is None:
            always += cclk
        else:
            sides.append(cclk)
    return always, sides


def _operations(line: int, counters: Sequence[Counter]) -> tuple[ExplainedOperation, ...]:
    """Return the operations of a line, those of both sides of its tests; a branch once for each way.

    An access that shares a bundle takes no cycles, so one operation may have several cycle counts.
    """
    counts: Tally[tuple[Op, int]] = Tally()
    for counter in counters:
        for each in counter.charges:
            if each.line.line == line and (each.times > 0 or counter.value is None):
                kind = each.op, each.issue_cclk
                counts[kind] = max(counts[kind], each.times) if counter.value else counts[kind] + each.times
    return tuple(
        ExplainedOperation(
            operation=op.value,
            mnemonic=MNEMONICS[op],
            count=count,
            cclk=cclk,
            conditional=op in BRANCHES,
        )
        for (op, cclk), count in counts.items()
    )
