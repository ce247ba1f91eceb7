// A function that returns as those of VisualDSP++ do, to the address that LINK has saved, from a loop; and a table with the address of
// one that it does not call.
  .text
  .global _summed
  .type _summed, STT_FUNC
_summed:
  LINK 0;
  P1 = R1;
  P2 = R0;
  R0 = 0;
  LSETUP (first, last) LC0 = P1;
first:
  R1 = B[P2++] (Z);
last:
  R0 = R0 + R1;
  P0 = [FP + 4];
  UNLINK;
  JUMP (P0);
  .size _summed, .-_summed
  .global _other
  .type _other, STT_FUNC
_other:
  R0 = 1;
  RTS;
  .size _other, .-_other
  .data
  .global _table
_table:
  .long _other
