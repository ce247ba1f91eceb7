"""Where every cycle went, and why: by stage, kernel, source line, buffer, reason, frame and caller."""
