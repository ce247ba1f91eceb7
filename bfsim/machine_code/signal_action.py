"""How machine code handles a signal of the host, in the form of Linux's C library."""

from __future__ import annotations

import ctypes

SA_SIGINFO, SA_NODEFER = 4, 0x40000000
"""Linux: the handler gets the address; the signal is not blocked while the handler runs, because it never returns."""


class SignalAction(ctypes.Structure):
    """The C library's `struct sigaction` on Linux."""

    _fields_ = (
        ("handler", ctypes.c_void_p),
        ("mask", ctypes.c_uint64 * 16),
        ("flags", ctypes.c_int),
        ("restorer", ctypes.c_void_p),
    )
