"""Quantities: each is one `Problem` object, which holds all that the program knows about it.

There is a folder for each topic (`fuzz/`) with a file for each quantity. A user declares another
quantity in the same way. The registry lists the quantities by name.
"""

from quantities.problem import Problem as Problem
from quantities.registry import curvatures as curvatures
from quantities.registry import problem as problem
from quantities.registry import problems as problems
from quantities.registry import register as register
from quantities.registry import samplers as samplers
