"""One driver per analysis kind."""
