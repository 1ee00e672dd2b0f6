"""Printing: the source code of a function, its names, statements, expressions and lines."""
