"""The shading models: pure JAX functions of one point, with no notion of integrals or fits.

Every function takes scalars and vectors of shape (3,), is differentiable, and leaves batching to
the caller's `jax.vmap`. Directions are unit vectors in a frame whose z axis is the surface normal.
"""

from shading.directions import direction as direction
from shading.directions import fiber_direction as fiber_direction
from shading.directions import sin2_between as sin2_between
from shading.layer import optical_path as optical_path
from shading.layer import penetration as penetration
from shading.layer import scattering_kernel as scattering_kernel
from shading.phase import fiber_phase_function as fiber_phase_function
from shading.phase import half_vector as half_vector
from shading.phase import schlick_phase_function as schlick_phase_function
from shading.phase import velvet_lobe as velvet_lobe
from shading.phase import velvet_phase_function as velvet_phase_function
from shading.sggx import fiber_matrix as fiber_matrix
from shading.sggx import fiber_normal_distribution as fiber_normal_distribution
from shading.sggx import fiber_projected_area as fiber_projected_area
from shading.sggx import fiber_root as fiber_root
from shading.sggx import normal_distribution as normal_distribution
from shading.sggx import phase_function as phase_function
from shading.sggx import projected_area as projected_area
from shading.sggx import reflect as reflect
from shading.sggx import sample_visible_normal as sample_visible_normal
from shading.sggx import visible_normal as visible_normal
