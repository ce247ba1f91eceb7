"""The Blackfin processor: object code → linked → decoded → costed → native code for this host.

`objects`, `linking` and `lines` say what lies where in its memory, and which source line it is of. `forms` is the instruction table,
data only. `decode` finds the row of some bytes, `text` prints it as GNU objdump does, `semantics` says what it does as LLVM IR,
`timing` what it costs, `translate` makes one native function of all code that can be reached (of `jumps`, `counting` and `alignment`),
and `processor` runs it on an `AddressSpace`.
"""
