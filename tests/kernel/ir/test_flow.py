"""Reading optimised LLVM IR: operands, loops, which loops count, and where blocks go."""

from __future__ import annotations

from bfsim.kernel import VDSP_O2
from bfsim.kernel.costs.call_paths import Program
from bfsim.kernel.costs.costs import Costs
from bfsim.kernel.estimate.costing import cost, optimised
from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.host_code.instrument import instrument
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.ir.text import Instruction
from tests.kernel import cost_kernels

INSTRUCTIONS = """
define range(i32 0, 9) i32 @f(ptr readonly captures(none) initializes((0, 36)) %a, i32 %label) #0 !dbg !3 {
entry:
  %0 = tail call range(i32 0, 7) i32 @llvm.umin.i32(i32 %label, i32 7), !dbg !6
  %1 = or disjoint i32 %0, 1, !dbg !6
  %2 = icmp samesign ult i32 %1, %0, !dbg !6
  %3 = getelementptr inbounds nuw [6 x i16], ptr @switch.table.f, i32 0, i32 %1, !dbg !6
  %4 = load i16, ptr %3, align 2, !dbg !6
  %5 = zext nneg i16 %4 to i32, !dbg !6
  %6 = select i1 %2, ptr %a, ptr %3, !dbg !6
  %7 = udiv exact i32 %5, 3, !dbg !6
  %8 = freeze i32 %7, !dbg !6
  store i8 -1, ptr %6, align 1, !dbg !6
  switch i32 %label, label %done [
    i32 -3, label %other.1thread-pre-split
    i32 5, label %done
  ], !dbg !7
other.1thread-pre-split:                                            ; preds = %entry
  br label %done, !dbg !7, !llvm.loop !9
done:                                             ; preds = %other.1thread-pre-split, %entry
  %9 = phi i32 [ %8, %entry ], [ poison, %other.1thread-pre-split ], [ %8, %entry ]
  ret i32 %9, !dbg !7
}
!3 = distinct !DISubprogram(name: "f", line: 1)
!6 = !DILocation(line: 4, column: 1, scope: !3)
!7 = !DILocation(line: 5, column: 1, scope: !3)
"""

LOOP = """
define void @f(ptr %a, i32 %n) {
entry:
  br label %iteration
iteration:                                             ; preds = %entry, %again
  %i = phi i32 [ 0, %entry ], [ %next, %again ]
  %kind = and i32 %i, 3
  switch i32 %kind, label %never [
    i32 0, label %even
    i32 1, label %again
    i32 2, label %even
    i32 3, label %again
  ]
even:                                             ; preds = %iteration, %iteration
  store i32 0, ptr %a, align 4
  br label %again
never:                                            ; preds = %iteration
  unreachable
again:                                            ; preds = %even, %iteration, %iteration
  %next = add nuw nsw i32 %i, 1
  %last = icmp eq i32 %next, %n
  br i1 %last, label %done, label %iteration
done:                                             ; preds = %again
  ret void
}
"""


def read_one(text: str) -> ControlFlow:
    """Read the only routine of `text`."""
    (routine,) = read_module(text)
    return ControlFlow(routine)


def test_every_form_of_instruction_is_read() -> None:
    """Flags, attributes, globals and casts around the operands do not hide or invent any."""
    flow = read_one(INSTRUCTIONS)
    assert flow.routine.parameters == ("%a", "%label")
    operands: dict[str, tuple[str, ...]] = {}
    each: Instruction
    for each in flow.blocks["entry"].instructions:
        operands.setdefault(each.opcode, each.operands)
    assert operands == {
        "call": ("%label", "7"),
        "or": ("%0", "1"),
        "icmp": ("%1", "%0"),
        "getelementptr": ("@switch.table.f", "0", "%1"),
        "load": ("%3",),
        "zext": ("%4",),
        "select": ("%2", "%a", "%3"),
        "udiv": ("%5", "3"),
        "freeze": ("%7",),
        "store": ("-1", "%6"),
        "switch": ("%label",),
    }
    assert flow.blocks["entry"].successors == ("done", "other.1thread-pre-split", "done")
    assert flow.blocks["entry"].cases == ((-3, "other.1thread-pre-split"), (5, "done"))
    assert flow.blocks["done"].instructions[0].operands == ("%8", "poison", "%8")
    assert [each.line.line for each in flow.blocks["entry"].instructions] == [4] * 10 + [5]


def test_every_form_of_instruction_has_a_cost() -> None:
    """A routine with all these forms is costed, and its table is no array of the kernel."""
    (routine,) = read_module(INSTRUCTIONS)
    counters = cost(routine, VDSP_O2)
    assert (
        sum(each.issue_cclk for each in counters if each.value is None) > len(INSTRUCTIONS.splitlines()) // 2
    )
    assert {name for each in counters for name, _, _ in each.array_accesses} <= {"a"}


def test_a_default_that_never_happens_is_no_way_out_of_a_loop() -> None:
    """A loop whose `switch` has an unreachable default still counts its iterations."""
    flow = read_one(LOOP)
    (loop,) = flow.loops
    assert loop.blocks == {"iteration", "even", "again"}
    assert ScalarEvolution(flow, InvariantCodeMotion(flow)).is_counted(loop)


def test_or_moves_an_address_only_where_it_adds() -> None:
    """`i | 1` is `i + 1` for even i only: LLVM says so with `disjoint`, and only then does it step."""
    for flag, slope in ((" disjoint", 1), ("", None)):
        odd = f"%odd = or{flag} i32 %i, 1\n  %kind"
        flow = read_one(LOOP.replace("%kind", odd, 1))
        advance = ScalarEvolution(flow, InvariantCodeMotion(flow)).increment("%odd", flow.loops[0])
        assert (advance.constant if advance else None) == slope


def test_the_costed_code_knows_nothing_of_the_host() -> None:
    """What is costed is compiled for one fixed target, in 32-bit integers and without vectors."""
    for kernel in (cost_kernels.copy_words, cost_kernels.suppress, cost_kernels.quotients):
        text = optimised(kernel.function, VDSP_O2)
        assert 'target triple = "riscv32-unknown-elf"' in text
        assert "target-cpu" not in text
        assert " x i" not in text  # <4 x i32>
        assert " i64 " not in text


def test_names_of_the_kernel_and_of_the_counters_never_meet() -> None:
    """Everything that counting adds begins with a dot, which no Python name does."""
    text = optimised(cost_kernels.store_each.function, VDSP_O2)
    function = cost_kernels.store_each.function
    counters = tuple(each for routine in read_module(text) for each in cost(routine, VDSP_O2))
    program = Program(function.symbol, Costs(counters), function.array_names)
    counted = instrument(text, function, program, "entry_name", traced=False, checked=False, as_written=False)
    assert 0 < counted.count("= alloca i64") <= len(counters)  # the others are derived
    added = [row.split(" = ")[0].strip() for row in counted.splitlines() if " = alloca i64" in row]
    assert all(name.startswith("%.bf.") for name in added)
