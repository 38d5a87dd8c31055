"""Buildings as structures of one degree of freedom that rock."""
