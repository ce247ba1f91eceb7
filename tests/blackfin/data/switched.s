// int switched(int x): a switch as GCC makes it, whose table is data.
  .text
  .global _switched
  .type _switched, STT_FUNC
_switched:
  P0.L = table;
  P0.H = table;
  P1 = R0;
  P0 = P0 + (P1 << 2);
  P0 = [P0];
  JUMP (P0);
ten:
  R0 = 10;
  RTS;
twenty:
  R0 = 20;
  RTS;
thirty:
  R0 = 30;
  RTS;
  .size _switched, .-_switched
  .data
  .align 4
table:
  .long ten, twenty, thirty
