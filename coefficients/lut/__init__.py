"""Lookup tables (LUTs): textures of values, how a GPU filters them, their errors and their files.

* `texture`: a `Lut` and its filters; `texels`: how values are rounded
* `baking`: `bake` makes a LUT of a function, `errors_of` measures it against exact values
* `beside`: the tables of a quantity beside a LUT of it
* `files`: `write_lut` writes it in one of the `FORMATS`
"""

from coefficients.lut.baking import bake as bake
from coefficients.lut.baking import errors_of as errors_of
from coefficients.lut.baking import scaled_for_lut as scaled_for_lut
from coefficients.lut.files import FORMATS as FORMATS
from coefficients.lut.files import require_format as require_format
from coefficients.lut.files import write_lut as write_lut
from coefficients.lut.texture import Lut as Lut
