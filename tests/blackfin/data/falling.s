// A function that goes on in the next one, and one that ends with an exception.
  .text
  .global _before
  .type _before, STT_FUNC
_before:
  P1 = R0;
  .size _before, .-_before
  .global _first
  .type _first, STT_FUNC
_first:
  P0 = R0;
  R0 = B[P0] (Z);
  RTS;
  .size _first, .-_first
  .global _trap
  .type _trap, STT_FUNC
_trap:
  EXCPT 3;
  .size _trap, .-_trap
  .global _behind
  .type _behind, STT_FUNC
_behind:
  RTS;
  .size _behind, .-_behind
