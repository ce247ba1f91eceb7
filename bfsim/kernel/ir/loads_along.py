"""Values that go along with an index through a loop, as they were loaded: the names of their next values end in `FOLLOWING`."""

from __future__ import annotations

from bfsim.kernel.ir.control_flow import ControlFlow

FOLLOWING = ".following"


def goes_along(flow: ControlFlow, value: str) -> bool:
    """Whether a value goes along with an index: a narrow one is extended wherever it is compared."""
    each = flow.instruction(value)
    return each is not None and each.opcode == "phi" and any(arm.endswith(FOLLOWING) for arm in each.operands)
