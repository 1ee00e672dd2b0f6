"""Curvature of surfaces for shading: the tensor of a triangle, curvature from light, and packing.

A curvature tensor II is the second fundamental form in a tangent frame (t, b) of the surface. It is
given by three numbers (II_tt, II_tb, II_bb) in 1/mm. It is positive where the surface is convex and
the normal points outwards, so a sphere of radius r has (1/r, 0, 1/r). `triangle` has the tensor of
a triangle, `frames` carries tensors to other planes, `from_light` reduces a tensor to the one
curvature that a skin fit takes, `equivalent` has the cylinder whose light is nearer still, and
`packing` stores a tensor in four bytes.
"""

from shading.curvature.equivalent import EquivalentCylinder as EquivalentCylinder
from shading.curvature.equivalent import drifted as drifted
from shading.curvature.equivalent import equivalent_cylinder as equivalent_cylinder
from shading.curvature.frames import carried as carried
from shading.curvature.frames import expressed as expressed
from shading.curvature.frames import rotated as rotated
from shading.curvature.frames import tangent_frame as tangent_frame
from shading.curvature.from_light import along_light as along_light
from shading.curvature.from_light import bending_along_light as bending_along_light
from shading.curvature.from_light import convex_part as convex_part
from shading.curvature.from_light import effective as effective
from shading.curvature.from_light import mean as mean
from shading.curvature.from_light import projected_light as projected_light
from shading.curvature.from_light import published as published
from shading.curvature.packing import packed as packed
from shading.curvature.packing import packing_error as packing_error
from shading.curvature.packing import unpacked as unpacked
from shading.curvature.triangle import corner_areas as corner_areas
from shading.curvature.triangle import corner_tensors as corner_tensors
from shading.curvature.triangle import face_tensor as face_tensor
