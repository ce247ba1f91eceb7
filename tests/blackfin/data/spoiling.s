// Functions that do not leave the registers of their caller as they were, and one that does.
  .text
  .global _spoils
  .type _spoils, STT_FUNC
_spoils:
  R7 = R0;
  P5 = R0;
  R0 = R7 + R0;
  RTS;
  .size _spoils, .-_spoils
  .global _leaves
  .type _leaves, STT_FUNC
_leaves:
  [--SP] = R0;
  RTS;
  .size _leaves, .-_leaves
  .global _keeps
  .type _keeps, STT_FUNC
_keeps:
  [--SP] = (R7:6, P5:4);
  R7 = R0;
  P5 = R7;
  R0 = R7 + R0;
  (R7:6, P5:4) = [SP++];
  RTS;
  .size _keeps, .-_keeps
