"""Pictures drawn by formulas, for measurements whose truth is known to a hundredth of a pixel."""
