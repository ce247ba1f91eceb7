"""One kernel, or all of them: line by line, its instructions, its estimate beside the real compiler's code."""
