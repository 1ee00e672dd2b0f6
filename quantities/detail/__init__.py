"""The operators of detail maps and their inverses, as functions to export."""

from quantities.detail.operators import OPERATORS as OPERATORS
