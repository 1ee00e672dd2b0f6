"""Curvature of meshes for skin: reading, tensors, smoothing, packing, and the exact diffusion."""

from shadefit.curvature.meshes import UNITS as UNITS
from shadefit.curvature.meshes import Mesh as Mesh
from shadefit.curvature.meshes import mesh as mesh
from shadefit.curvature.tensors import Curvature as Curvature
from shadefit.curvature.tensors import curvature as curvature
from shadefit.curvature.tensors import in_frames as in_frames
