"""A process that ends when another one lets go of it, whatever it is doing: an endless kernel may keep Python's lock."""

from __future__ import annotations

import ctypes
from threading import Thread

from bfsim import machine_code
from bfsim.machine_code.native_code import native_code

END_WITH = "bfsim_end_with"
MODULE = f"""
declare i64 @read(i32, ptr, i64)
declare void @_exit(i32) noreturn

define void @{END_WITH}(i32 %leash) {{
  %octet = alloca i8
  br label %wait
wait:
  %got = call i64 @read(i32 %leash, ptr %octet, i64 1)
  %is.interrupted = icmp slt i64 %got, 0
  br i1 %is.interrupted, label %wait, label %end
end:
  call void @_exit(i32 1)
  unreachable
}}
"""


def end_with(leash: int) -> None:
    """End this process with exit code 1 when the other end of a pipe is closed. `leash` is the number of this end."""
    machine_code.add(native_code(MODULE))
    wait = ctypes.CFUNCTYPE(None, ctypes.c_int32)(machine_code.address_of(END_WITH))
    Thread(target=wait, args=(leash,), daemon=True).start()
