"""The kinds of [structure]: each table beside its maker."""
