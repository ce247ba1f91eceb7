// A function that does not return for a number other than 0.
  .text
  .global _spin
  .type _spin, STT_FUNC
_spin:
  CC = R0 == 0;
.Lturn:
  IF !CC JUMP .Lturn;
  RTS;
  .size _spin, .-_spin
