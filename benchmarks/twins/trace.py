"""Instruction traces of the GNU Blackfin simulator: what a kernel executed, and what that simulator charges for it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

# Text of an instruction in the trace → class it is counted as; the first match decides.
CLASSES = (
    (r"^IF (! )?CC JUMP", "branch"),
    (r"^IF (! )?CC ", "cond_move"),
    (r"^JUMP", "jump"),
    (r"^CALL", "call"),
    (r"^RTS", "ret"),
    (r"^LSETUP", "loop_setup"),
    (r"^\[--SP\] = \(", "push_multiple"),
    (r"^\(.*\) = \[SP\+\+\]", "pop_multiple"),
    (r"^\[--SP\] =", "push"),
    (r"= \[SP\+\+\]", "pop"),
    (r"^LINK", "link"),
    (r"^UNLINK", "unlink"),
    (r"^B\[.*\] =", "store8"),
    (r"^W\[.*\] =", "store16"),
    (r"^\[.*\] =", "store32"),
    (r"= B\[", "load8"),
    (r"= W\[", "load16"),
    (r"= \[", "load32"),
    (r"^DIV[SQ]\b", "div_step"),
    (r"^M?NOP", "nop"),
    (r"^[CS]SYNC", "sync"),
    (r"^CC = !?\s?BITTST", "bit_test"),
    (r"^CC = \S+ (==|<=|<) ", "compare"),
    (r"^CC = (R\d|! ?CC|AZ|AN|AC0|AV0|AV1|AQ|VS?)\b", "cc_move"),
    (r"^CC [&|^]?= ", "cc_move"),
    (r"^(AZ|AN|AC0|AQ|V) [|&^]?= CC", "cc_move"),
    (r"^R\d = CC", "cc_move"),
    (r"^R\d \*= R\d", "mul32"),
    (r"^A[01].* \* ", "mac"),
    (r"^R\d.* = .* \* .*", "mul16"),
    (r"^R\d = A[01]", "acc_move"),
    (r"^A[01](\.[XWLH])? = (R\d|0|A[01];|A[01]$)", "acc_move"),
    (r"^A[01] [+-]= A[01]", "acc_add"),
    (r"^A[01] = A[01] (<<|>>|>>>)", "acc_shift"),
    (r"^R\d = ROT R\d BY 0\b", "move"),
    (r"^R(\d) = R\1 -\|- R\1", "zero"),
    (r"^R\d = R\d\.[LB] \([ZX]\)", "extend"),
    (r"^([RPIMBL]\d|SP|FP)\.[LH] = (0|-?0x)", "imm_half"),
    (r"^([RPIMBL]\d|SP|FP) = -?0x[0-9a-f]+( \([XZ]\))?", "imm"),
    (r"^([A-Z]+\d?) = ([A-Z]+\d?);?$", "move"),
    (r"^([RP]\d|SP|FP) (<<|>>|>>>)= ", "shift"),
    (r"^(R\d|P\d|SP|FP) = (R\d|P\d|SP|FP) (<<|>>|>>>) ", "shift"),
    (r"^R\d(\.[LH])? = (ASHIFT|LSHIFT|ROT|EXTRACT|DEPOSIT)", "shift"),
    (r"^R\d(\.[LH])? = R\d\.[LH] (<<|>>|>>>) ", "shift"),
    (r"^(R\d|P\d|SP|FP) = \((R\d|P\d|SP|FP) \+ (R\d|P\d|SP|FP)\) << ", "add_shift"),
    (r"^(P\d|SP|FP) = (P\d|SP|FP) \+ \((P\d|SP|FP) << ", "add_shift"),
    (r"^([RP]\d|SP|FP) (\+=|-=|&=|\|=|\^=)", "alu"),
    (r"^[IBM]\d [+-]= ", "alu"),
    (r"^BIT(SET|CLR|TGL)", "bit_op"),
    (r"^R\d(\.[LH])? = (ABS|MIN|MAX|-|~|ONES|SIGNBITS|PACK)", "alu"),
    (r"^([RP]\d|SP|FP) = ([RP]\d|SP|FP) ([-+&|^]) ", "alu"),
    (r"^R\d\.[LH] = R\d\.[LH] [-+] R\d\.[LH]", "alu"),
    (r"^R\d = R\d [-+]\|[-+] R\d", "alu"),
)
PATTERNS = tuple((re.compile(pattern), name) for pattern, name in CLASSES)

# Cycles of an instruction by its class, 1 if not listed: CYCLE_DELAY in sim/bfin/bfin-sim.c (gdb 13.1).
CYCLES = {
    "jump": 5, "call": 5, "ret": 5, "push_multiple": 14, "pop_multiple": 11, "link": 3, "unlink": 2, "mul32": 3,
    "branch_taken": 9, "branch_not_taken": 1, "branch_taken_bp": 5, "branch_not_taken_bp": 9,
}  # fmt: skip

SAVED = re.compile(r"\((?:R7:(\d))?(?:, )?(?:P5:(\d))?\)")


class Step(NamedTuple):
    """One executed operation: address of its instruction, place in a parallel bundle, text."""

    pc: int
    slot: int
    text: str


def steps(lines: Iterable[bytes]) -> Iterator[Step]:
    """Read a trace: `insn: ADDRESS || WORD -TEXT` line after line, `||` in the up to three of a bundle."""
    known: dict[bytes, Step] = {}
    bundle_pc, slot = -1, 0
    for raw in lines:
        bundled = raw[19:21] == b"||"
        key = raw[:18] + raw[40:] if bundled else raw
        if key not in known:
            line = raw.decode("ascii")
            known[key] = Step(int(line[5:18], 16), 0, line[line.index("-", 18) + 1 :].strip())
        step = known[key]
        slot = slot + 1 if bundled and step.pc == bundle_pc and slot < 2 else 0
        bundle_pc = step.pc if bundled else -1
        yield step._replace(slot=slot) if slot else step


def executed(trace: Iterable[Step], entry: int) -> tuple[Counter[Step], Counter[Step]]:
    """Count the steps from every call of the function at `entry` to its return, and the branches taken there."""
    count: Counter[Step] = Counter()
    taken: Counter[Step] = Counter()
    before, inside, back = Step(0, 0, ""), False, (0, 0)
    for step in trace:
        if step.slot == 0:
            if "CC JUMP" in before.text and step.pc != before.pc + 2 and inside:
                taken[before] += 1
            if before.text.startswith("RTS") and step.pc in back:
                inside = False
            elif before.text.startswith("CALL") and step.pc == entry and not inside:
                inside, back = True, (before.pc + 2, before.pc + 4)
            before = step
        count[step] += inside
    return +count, taken


def summary(count: Counter[Step], taken: Counter[Step]) -> dict[str, Any]:
    """Return the cycles of the counted steps, also with 1 per register of a push or pop multiple, and their classes."""
    mix: Counter[str] = Counter()
    cycles = by_register = 0
    for step, times in count.items():
        for name, part in _classes(step, times, taken[step]):
            mix[name] += part
            if step.slot == 0:
                each = CYCLES.get(name, 1)
                cycles += part * each
                by_register += part * (_saved(step.text) if name.endswith("multiple") else each)
    return {
        "cycles": cycles,
        "cycles_pushpop_by_register": by_register,
        "mix_detail": {name: mix[name] for name in sorted(mix) if mix[name]},
    }


def _classes(step: Step, times: int, taken: int) -> list[tuple[str, int]]:
    name = next((name for pattern, name in PATTERNS if pattern.search(step.text)), None)
    if name is None:
        raise ValueError(f"an instruction must be of a known class, not {step.text!r} (at {step.pc:#x})")
    if name != "branch":
        return [(name, times)]
    hint = "_bp" if "(bp)" in step.text else ""
    return [(f"branch_taken{hint}", taken), (f"branch_not_taken{hint}", times - taken)]


def _saved(text: str) -> int:
    match = SAVED.search(text)
    assert match
    return sum(top - int(lowest) for top, lowest in zip((8, 6), match.groups(), strict=True) if lowest)
