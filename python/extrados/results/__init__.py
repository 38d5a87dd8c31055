"""The results store: what an analysis returns, how it is written and read back."""
