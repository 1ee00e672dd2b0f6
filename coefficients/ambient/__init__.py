"""The fuzz layer and its base in ambient light, as complete functions to export.

* `tables`: G, Q and R of the tables that they use
* `radiance`: the functions, and the parts of their cost
* `problems`: the same as quantities without forms, which all commands for code know
"""

from coefficients.ambient.problems import ambient_problems as ambient_problems
from coefficients.ambient.radiance import PARTS as PARTS
from coefficients.ambient.radiance import ambient_function as ambient_function
from coefficients.ambient.radiance import part_costs as part_costs
