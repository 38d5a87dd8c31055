"""Statistics of rocking over many motions."""
