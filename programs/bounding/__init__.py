"""Proven bounds of a program on whole boxes, by interval arithmetic and branch and bound."""
