"""The process that bfsim runs in: how it ends and prints, what it reads ahead and remembers."""
