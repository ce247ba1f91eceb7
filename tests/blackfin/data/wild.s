.text
.global _wild
_wild:
  P0 = R0;
  [P0] = R0;
  RTS;
