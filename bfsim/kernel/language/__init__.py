"""The kernel language: the Python source of a function → its typed tree, or a refusal that says where and why."""
