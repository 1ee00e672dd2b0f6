"""Straight-line programs: what a JAX function of scalars computes, one operation at a time.

A program is traced from the function's jaxpr. Shader code is printed from it, its operations are
counted, and its values are bounded over whole boxes: one expression for all of them.
"""
