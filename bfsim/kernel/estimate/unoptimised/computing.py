"""The interface that computes expressions at -O0, as the parts of an expression see it: each lets it compute its operands."""

from __future__ import annotations

from abc import ABC, abstractmethod

from bfsim.kernel.estimate.unoptimised.expressions import Expr
from bfsim.kernel.estimate.unoptimised.registers import Registers


class Computing(Registers, ABC):
    """Computes expressions and addresses. A method that returns a bool says whether the result is in a pointer register."""

    @abstractmethod
    def value(self, each: Expr, *, adds: bool = False, waits: bool = False, outermost: bool = False) -> bool:
        """Compute `each`. `adds`: an addition or a copy uses it; `waits`: others are computed before it is used.

        `outermost`: it is all that an assignment computes.
        """

    @abstractmethod
    def address(self, element: Expr) -> None:
        """Put the address of an element into a pointer register."""
