"""From pictures of a chessboard to cameras whose lenses are known."""
