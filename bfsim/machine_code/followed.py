"""Machine code followed by a call of other machine code, before anyone sees what the first call has left."""

from __future__ import annotations

from functools import cache

from bfsim import machine_code
from bfsim.machine_code.caller import field
from bfsim.machine_code.native_code import native_code

FIRST, DATA, SECOND, WORDS_AT = range(4)
"""Words of `data`: the first function, its data, the second function, and its three arguments."""

MODULE = f"""
define i64 @bfsim_call_both(ptr %data, ptr %handed, ptr %cost) {{
{field("first", FIRST, "ptr", "data")}{field("its.data", DATA, "ptr", "data")}{field("second", SECOND, "ptr", "data")}\
{"".join(field(name, WORDS_AT + number, "i64", "data") for number, name in enumerate(("one", "two", "three")))}\
  %status = call i64 %first(ptr %its.data, ptr %handed, ptr %cost)
  %has.failed = icmp slt i64 %status, 0
  br i1 %has.failed, label %done, label %then
then:
  call void %second(i64 %one, i64 %two, i64 %three)
  br label %done
done:
  ret i64 %status
}}
"""


@cache
def call_both() -> int:
    """Return the address of code that calls both, the second only if the first has not failed."""
    machine_code.add(native_code(MODULE))
    return machine_code.address_of("bfsim_call_both")
