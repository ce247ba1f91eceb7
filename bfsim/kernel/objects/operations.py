"""Instructions of the Blackfin by the classes in which operations are counted."""

from __future__ import annotations

from bfsim.blackfin.instructions.decode import Instruction, Operation
from bfsim.kernel.operations import Op

OF_FORM = {
    **dict.fromkeys(("add_pointers", "add_and_shift_pointers", "add_and_shift", "add_reversed"), Op.ADD_SHIFT),
    **dict.fromkeys(("set_register", "set_low", "set_high"), Op.IMM),
    **dict.fromkeys(("move", "pop_part"), Op.MOVE),
    **dict.fromkeys(("shift", "shift_pointer", "shift_by_register"), Op.SHIFT),
    **dict.fromkeys(("compare", "compare_accumulators"), Op.COMPARE),
    **dict.fromkeys(("cc_from_register", "cc_from_status", "cc_to_status", "register_from_cc", "invert_cc"), Op.CC_MOVE),
    **dict.fromkeys(("jump", "jump_to", "jump_relative"), Op.JUMP),
    **dict.fromkeys(("call", "call_to", "call_relative"), Op.CALL),
    **dict.fromkeys(("load_half", "load_indexed_half"), Op.LOAD16),
    **dict.fromkeys(("store_half", "store_indexed_half"), Op.STORE16),
    "extend": Op.EXTEND, "test_bit": Op.BIT_TEST, "move_if": Op.COND_MOVE, "loop_setup": Op.LOOP_SETUP,
    "multiply_32": Op.MUL32, "branch": Op.BRANCH_NOT_TAKEN, "branch_predicted": Op.BRANCH_NOT_TAKEN_BP,
    "return_": Op.RETURN, "link": Op.LINK, "unlink": Op.UNLINK, "push": Op.PUSH, "pop": Op.POP,
    "push_multiple": Op.PUSH_MULTIPLE, "pop_multiple": Op.POP_MULTIPLE, "nothing": Op.NOP,
    "load_indexed": Op.LOAD32, "store_indexed": Op.STORE32,
}  # fmt: skip
"""Classes by what a form does; other forms are arithmetic."""
LOADS = {1: Op.LOAD8, 2: Op.LOAD16, 4: Op.LOAD32}
STORES = {1: Op.STORE8, 2: Op.STORE16, 4: Op.STORE32}
TAKEN = {Op.BRANCH_NOT_TAKEN: Op.BRANCH_TAKEN, Op.BRANCH_NOT_TAKEN_BP: Op.BRANCH_TAKEN_BP}
"""What a branch counts as if it is taken."""
LONG_BYTES = 4


def operation_of(instruction: Instruction) -> Op:
    """Return the class of an instruction; for a bundle, that of its first instruction that is not a NOP."""
    found = [_class(each) for each in instruction.operations]
    return next((each for each in found if each is not Op.NOP), Op.NOP)


def _class(operation: Operation) -> Op:
    form = operation.form
    if form.does in ("load", "store"):
        return (LOADS if form.does == "load" else STORES)[int(form.given.get("nbytes", LONG_BYTES))]
    if "*" in form.text and form.does not in OF_FORM:
        return Op.MAC if "A0" in form.text or "A1" in form.text else Op.MUL16
    return OF_FORM.get(form.does, Op.DSP_ALU if form.length == LONG_BYTES else Op.ALU)
