"""Python with NumPy 2: every argument may be an array, and they broadcast."""

import keyword

from programs.languages.c_family import MATH
from programs.languages.language import Binding, Spelling, Target, spell, words

_NAMES = {operation: f"np.{name}" for operation, name in MATH.items()} | {
    "abs": "np.abs",
    "asin": "np.arcsin",
    "acos": "np.arccos",
    "atan": "np.arctan",
    "atan2": "np.arctan2",
    "pow": "np.power",
    "min": "np.minimum",
    "max": "np.maximum",
    "and": "np.logical_and",
    "or": "np.logical_or",
    "not": "np.logical_not",
}
_FUNCTIONS = spell(
    {
        **_NAMES,
        "rsqrt": Spelling("1.0 / np.sqrt({0})", Binding.PRODUCT),
        "select": Spelling("np.where({0}, {1}, {2})"),
    }
)
_TYPES = {"half": "np.float16", "float": "np.float32", "double": "np.float64"}

TARGET = Target(
    key="python",
    name="Python",
    extension="py",
    types=_TYPES,
    # A bare literal takes the type of the array beside it.
    literals=dict.fromkeys(_TYPES, "{}"),
    functions=dict.fromkeys(_TYPES, _FUNCTIONS),
    reserved=frozenset(keyword.kwlist) | words("np print len range float int match case type"),
    prologue=dict.fromkeys(_TYPES, ("import numpy as np",)),
    comment="#",
    scalar_in="{name}",
    array_in="{name}",
    array_out="",
    head_one="def {function}({arguments}):",
    head_many="def {function}({arguments}):",
    opening=None,
    closing=None,
    local="{name} = {value}",
    give="return {value}",
    several="return ({values})",
    table_opening="{name} = (",
    table_closing=")",
    receive_scalar="{name} = np.asarray({name}, {type})",
    receive_array="{name} = [np.asarray(each, {type}) for each in {name}]",
    lone_literal="{type}({})",
    bracketed=True,
)
