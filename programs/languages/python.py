"""Python with NumPy 2. Arguments may be arrays, which broadcast."""

import keyword

from programs.languages.c_family import MATH
from programs.languages.script_names import PYTHON_LIBRARY
from programs.languages.spelling import Language, Precedence, Spelling, spell, words

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
        "rsqrt": Spelling("1.0 / np.sqrt({0})", Precedence.PRODUCT),
        "select": Spelling("np.where({0}, {1}, {2})"),
    }
)
_TYPES = {"half": "np.float16", "float": "np.float32", "double": "np.float64"}

LANGUAGE = Language(
    key="python",
    name="Python",
    extension="py",
    types=_TYPES,
    # A literal takes the type of the array that it is combined with.
    literals=dict.fromkeys(_TYPES, "{}"),
    functions=dict.fromkeys(_TYPES, _FUNCTIONS),
    reserved=frozenset(keyword.kwlist) | words("np print len range float int match case type"),
    library=PYTHON_LIBRARY,
    record_opening=None,
    preprocessor=False,
    prologue=dict.fromkeys(_TYPES, ("import numpy as np",)),
    comment="#",
    scalar_argument="{name}",
    array_argument="{name}",
    array_result="",
    scalar_head="def {function}({arguments}):",
    array_head="def {function}({arguments}):",
    body_opening=None,
    body_closing=None,
    local_variable="{name} = {value}",
    return_statement="return {value}",
    return_all="return ({values})",
    return_three="({values})",
    table_opening="{name} = (",
    table_closing=")",
    scalar_conversion="{name} = np.asarray({name}, {type})",
    array_conversion="{name} = [np.asarray(each, {type}) for each in {name}]",
    vectors_conversion="{name} = [[np.asarray(k, {type}) for k in each] for each in {name}]",
    typed_literal="{type}({})",
    parenthesize_lines=True,
)
