// A register that the Blackfin has not is a symbol for the assembler.
  .text
  .global _undefined
  .type _undefined, STT_FUNC
_undefined:
  R0 = R9;
  RTS;
  .size _undefined, .-_undefined
