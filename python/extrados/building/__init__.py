"""What a building is, and the views of it that each strategy takes."""
