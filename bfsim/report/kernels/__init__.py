"""One kernel, or each: line by line, its instructions, its estimate beside the real compiler's code."""
