"""Proven bounds of a program over whole boxes: interval arithmetic, branch and bound."""
