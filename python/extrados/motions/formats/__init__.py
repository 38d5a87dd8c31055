"""Readers of accelerogram files, told apart by content."""
