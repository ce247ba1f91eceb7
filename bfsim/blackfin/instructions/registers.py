"""The registers of a core, their numbers in an encoding, and where they stand in the state that native code works on."""

from __future__ import annotations

WORD_BYTES = 4
"""Bytes of a register, and of a word in memory."""

DATA = tuple(f"R{number}" for number in range(8))
POINTERS = (*(f"P{number}" for number in range(6)), "SP", "FP")
DAG = tuple(f"{bank}{number}" for bank in "IMBL" for number in range(4))
"""Registers of the data address generators: index, modify, base, length."""
RESERVED = ""

ENCODED = (
    *DATA,
    *POINTERS,
    *DAG,
    *("A0.X", "A0.W", "A1.X", "A1.W", RESERVED, RESERVED, "ASTAT", "RETS"),
    *(8 * (RESERVED,)),
    *("LC0", "LT0", "LB0", "LC1", "LT1", "LB1", "CYCLES", "CYCLES2"),
    *("USP", "SEQSTAT", "SYSCFG", "RETI", "RETX", "RETN", "RETE", "EMUDAT"),
)
"""Registers by their six-bit number, a group and a register in it (programming reference, table C-4)."""

FLAGS = {
    "AZ": 0, "AN": 1, "AC0_COPY": 2, "V_COPY": 3, "CC": 5, "AQ": 6, "RND_MOD": 8,
    "AC0": 12, "AC1": 13, "AV0": 16, "AV0S": 17, "AV1": 18, "AV1S": 19, "V": 24, "VS": 25,
}  # fmt: skip
"""The bits of ASTAT that mean something, each a register of one bit here."""
COPIES = {"AC0": "AC0_COPY", "V": "V_COPY"}
"""Writing the one also writes the other."""
ASTAT_UNUSED = 0xFFFFFFFF & ~sum(1 << place for place in FLAGS.values())

ACCUMULATORS = ("A0", "A1")
"""40 bits, kept sign-extended to 64. Their parts .X (the upper 8) and .W (the lower 32) are not registers of their own."""

ACCUMULATOR_PARTS = ("A0.X", "A0.W", "A1.X", "A1.W")
_PLAIN = tuple(each for each in ENCODED[32:] if each and each[0] != "A" and not each.startswith("CYCLES"))
STATE = (
    *("PC", "CLOCK", "WAITED", "FUEL", "ARGUMENT", "TRACE", "FROM"),
    *(*DATA, *POINTERS, *DAG, *ACCUMULATORS, *FLAGS, "ASTAT_UNUSED"),
    *(*_PLAIN, "CYCLES_OFFSET", "CYCLES2"),
)
"""The registers in native code, each in 64 bits of the state. PC: where to start, and where it was left. CLOCK: all
cycles so far; WAITED: those that instructions have waited since native code was entered; CYCLES_OFFSET: CYCLES less
CLOCK while it counts, and CYCLES itself while it does not (SYSCFG has the switch). FUEL: how many blocks may still be
run. ARGUMENT: that of the event for which it was left. TRACE: where accesses are reported to (`tracing`). FROM: in code
that is not trusted, the instruction that went to a computed address which the code does not have (`translate`)."""
SLOTS = {name: slot for slot, name in enumerate(STATE)}


def width(name: str) -> int:
    """Return how many bits native code has for a register."""
    if name in FLAGS:
        return 1
    return 64 if name in {*ACCUMULATORS, "CLOCK", "WAITED", "FUEL", "TRACE", "CYCLES_OFFSET"} else 32
