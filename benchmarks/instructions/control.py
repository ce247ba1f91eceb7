"""Short programs of control flow and the stack, in assembler: hardware loops in all their corners, calls, branches, frames.

Each ends behind its last line. SP is at the end of a small memory when it starts, and all other registers are 0.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

PROGRAMS = {
    "loop": "P0 = 5; LSETUP (1f, 2f) LC0 = P0; 1: R0 += 1; 2: R1 = R1 + R0;",
    "loop of one instruction": "P0 = 7; LSETUP (1f, 1f) LC1 = P0; 1: R0 += 3;",
    "loop of half the counter": "P0 = 9; LSETUP (1f, 1f) LC0 = P0 >> 1; 1: R0 += 1;",
    "loop with counter 0 runs once": "P0 = 0; LSETUP (1f, 2f) LC0 = P0; 1: R0 += 1; 2: R1 += 1;",
    "loop whose counter is set before": "P0 = 4; LC0 = P0; LSETUP (1f, 1f) LC0; 1: R0 += 1;",
    "nested loops": "P0 = 4; P1 = 3; LSETUP (1f, 4f) LC0 = P0; 1: R0 += 1; LSETUP (2f, 3f) LC1 = P1; 2: R1 += 1; 3: R2 = R2 + R1; "
    "4: R3 = R3 + R2;",
    "nested loops with one end": "P0 = 4; P1 = 3; LSETUP (1f, 3f) LC0 = P0; 1: R0 += 1; LSETUP (2f, 3f) LC1 = P1; 2: R1 += 1; "
    "3: R2 = R2 + R1;",
    "loop that is left": "P0 = 9; LSETUP (1f, 2f) LC0 = P0; 1: R0 += 1; CC = R0 == 3; IF CC JUMP 3f; 2: R1 += 1; 3: R2 = 1;",
    "loop that ends with a branch": "P0 = 6; R2 = 3; LSETUP (1f, 2f) LC0 = P0; 1: R0 += 1; CC = R0 < R2; 2: IF !CC JUMP 3f; R1 = 9; 3: R3 = 5;",
    "loop that ends with a call": "P0 = 3; LSETUP (1f, 2f) LC0 = P0; 1: R0 += 1; 2: CALL 3f; JUMP 4f; 3: R1 += 2; RTS; 4: R2 = RETS;",
    "branches": "R0 = 3; 1: R0 += -1; CC = R0 == 0; IF !CC JUMP 1b; IF CC JUMP 2f; R1 = 1; 2: R2 = CC;",
    "predicted branches": "R0 = 3; 1: R0 += -1; CC = R0 == 0; IF !CC JUMP 1b (BP); IF CC JUMP 2f (BP); R1 = 1; 2: R2 = CC;",
    "calls": "P0 = 5; [--SP] = RETS; CALL 1f; RETS = [SP++]; JUMP 2f; 1: LINK 16; [FP + -4] = P0; R0 = [FP + -4]; UNLINK; RTS; 2: R1 = RETS;",
    "recursion": "R0 = 6; R1 = 1; CALL 1f; JUMP 3f; 1: LINK 0; CC = R0 == 0; IF CC JUMP 2f; R1 *= R0; R0 += -1; CALL 1b; 2: UNLINK; RTS; "
    "3: R2 = R1;",
    "computed": "P1.L = 1f; P1.H = 1f; CALL (P1); R4 = 9; JUMP 2f; 1: R0 += 1; RTS; 2: P2.L = 3f; P2.H = 3f; JUMP (P2); R1 = 1; 3: P3 = 8; "
    "CALL (PC + P3); JUMP 4f; NOP; NOP; R2 = 4; RTS; 4: R3 = 2;",
    "registers on the stack": "R7 = 7; R6 = 6; R5 = 5; P5 = 15; P4 = 14; [--SP] = (R7:5, P5:4); R7 = 0; P5 = 0; (R7:6) = [SP++]; "
    "(P5:4) = [SP++]; R0 = SP; [--SP] = (P5:3); [--SP] = (R7:7); R1 = SP;",
    "registers of a loop on the stack": "P0 = 3; LSETUP (1f, 2f) LC0 = P0; 1: [--SP] = LC0; [--SP] = LT0; [--SP] = LB0; P1 = 2; "
    "LSETUP (3f, 3f) LC0 = P1; 3: R0 += 1; LB0 = [SP++]; LT0 = [SP++]; LC0 = [SP++]; 2: R1 += 1;",
    "cycles": "R0 = SYSCFG; BITSET (R0, 1); SYSCFG = R0; CSYNC; R1 = CYCLES; R2 = CYCLES; R3 *= R2; SSYNC; R4 = CYCLES; R5 = CYCLES2; "
    "R6 = 100; CYCLES = R6; R7 = CYCLES;",
    "divisions": "R0 = 100; R1 = 7; R0 <<= 1; P0 = 15; DIVS (R0, R1); LSETUP (1f, 1f) LC0 = P0; 1: DIVQ (R0, R1);",
}
"""By what they are about."""


def assembled(program: str, folder: Path, address: int) -> bytes:
    """Return the code of a program at an address."""
    source, made, linked = (folder / f"control.{each}" for each in ("s", "o", "elf"))
    source.write_text(".global __start\n__start:\n" + program.replace(";", ";\n") + "\n")
    subprocess.run(["bfin-elf-as", source, "-o", made], check=True)
    subprocess.run(["bfin-elf-ld", f"-Ttext={address:#x}", made, "-o", linked], check=True)
    subprocess.run(["bfin-elf-objcopy", "-O", "binary", "-j", ".text", linked, made], check=True)
    return made.read_bytes()
