"""Quantities: each is one `Problem` that says all that the program knows of it.

A folder a topic declares them (`fuzz/`), in the same terms in which a user declares another. The
registry lists them by name.
"""

from quantities.problem import Problem as Problem
from quantities.registry import problem as problem
from quantities.registry import problems as problems
from quantities.registry import register as register
