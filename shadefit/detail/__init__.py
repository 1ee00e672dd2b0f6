"""Detail maps: sources that give a target with a tiled detail, compressed for the composed result.

The operators of single texels are those of `shading.detail`.
"""

from shadefit.detail.closed_loop import closed_loop as closed_loop
from shadefit.detail.compensation import ComposedErrors as ComposedErrors
from shadefit.detail.compensation import compensated_dds as compensated_dds
from shadefit.detail.compensation import compensated_image as compensated_image
from shadefit.detail.compensation import composed_image as composed_image
from shadefit.detail.compensation import errors_between as errors_between
from shadefit.detail.operators import OPERATORS as OPERATORS
from shadefit.detail.operators import Operator as Operator
from shadefit.detail.operators import operator as operator
