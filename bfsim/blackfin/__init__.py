"""The Blackfin processor: object code → linked → decoded → costed → native code for this host.

`elf` says what lies where in its memory, and which source line it comes from. `instructions.forms` is the instruction
table, data only. `instructions.decode` finds the row of some bytes, `text` prints it as GNU objdump does, `semantics`
says what it does as LLVM IR, `timing` what it costs. `translation` makes one native function of all code that can be
reached (`control_flow`), and `execution.processor` runs it on an `AddressSpace`.
"""
