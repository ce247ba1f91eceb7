"""Arguments that a single sum takes to compute an address: they wait in the data registers that they come in [reload1.cc of GCC 12].

Either bank is as good for them as the other, so they stay where they are. The sum is in pointer registers, and reload
moves them there at the sum, not when the function is entered: until then, no pointer register is taken.
"""

from __future__ import annotations

from bfsim.kernel import operations
from bfsim.kernel.estimate.registers.webs import Webs
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.operations import Op

DATA, POINTER = RegisterBank.DATA, RegisterBank.POINTER


def let_arguments_wait(webs: Webs) -> None:
    """Put such arguments of one routine into data registers; they are moved where they are used."""
    chosen = webs.context.operands_of("phi")
    for name in webs.context.parameters()[: operations.REGISTER_ARGUMENTS]:
        users = [
            (label, each)
            for label, block in webs.code.of.items()
            for each in block
            if name in (used for used, _ in each.uses)
        ]
        if len(users) != 1 or name in chosen or webs.bank.get(webs.find(name)) is not POINTER:
            continue
        ((label, user),) = users
        if webs.flow.innermost(label) is None and _is_sum(webs, user):
            webs.bank[webs.find(name)] = DATA
            user.uses = tuple((used, POINTER) for used, _ in user.uses)


def _is_sum(webs: Webs, each: MachineInstruction) -> bool:
    """Whether an operation adds two values in pointer registers."""
    values = [name for name, _ in each.uses if not name.startswith("#")]
    return each.op is Op.ALU and len(values) == 2 and webs.bank.get(webs.find(each.result or "")) is POINTER
