/* int clocked(int turns): the cycles of so many turns of a loop, as code that measures itself reads them. */
.text
.global _clocked
.type _clocked, STT_FUNC
_clocked:
  P0 = R0;
  R1 = CYCLES;
  LSETUP (.Lturn, .Lend) LC0 = P0;
.Lturn:
    R2 = R2 + R0;
.Lend:
    R2 = R2 ^ R0;
  R0 = CYCLES;
  R0 = R0 - R1;
  RTS;
.size _clocked, . - _clocked
