"""Source code of a program: names, statements, expressions and lines."""
