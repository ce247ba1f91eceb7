"""How control goes through code: blocks, loops, calls, and where pointers lead."""
