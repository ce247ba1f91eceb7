// Code that names labels by their halves: a hardware loop that no LSETUP sets up, and a call of what is not said to be a function;
// and a table of labels that stands in code.
  .text
  .global _turns
  .type _turns, STT_FUNC
_turns:
  R1.L = first;
  R1.H = first;
  LT0 = R1;
  R1.L = last;
  R1.H = last;
  LB0 = R1;
  LC0 = R0;
  R2 = 0;
first:
  R2 += 3;
last:
  R2 = R2 + R0;
  R0 = R2;
  RTS;
  .size _turns, .-_turns
doubled:
  R0 <<= 1;
  RTS;
  .global _twice
  .type _twice, STT_FUNC
_twice:
  [--SP] = RETS;
  P1.L = doubled;
  P1.H = doubled;
  CALL (P1);
  RETS = [SP++];
  RTS;
  .size _twice, .-_twice
  .global _chosen
  .type _chosen, STT_FUNC
_chosen:
  P0.L = table;
  P0.H = table;
  P1 = R0;
  P0 = P0 + (P1 << 2);
  P0 = [P0];
  JUMP (P0);
  .align 4
table:
  .long ten, twenty, thirty
ten:
  R0 = 10;
  RTS;
twenty:
  R0 = 20;
  RTS;
thirty:
  R0 = 30;
  RTS;
  .size _chosen, .-_chosen
