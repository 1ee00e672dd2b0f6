"""The shading models, as pure JAX functions of one point.

Every function takes scalars and vectors of shape (3,) and is differentiable. Use `jax.vmap` to
evaluate many points. Directions are unit vectors in a frame whose z axis is the surface normal.
Generic models (directions, SGGX, phase functions, spherical harmonics) are in this folder. Each
topic, such as `fuzz/`, has a folder of its own. Nothing here knows of integrals or fits.
"""

from shading.directions import direction as direction
from shading.directions import direction_cosines as direction_cosines
from shading.directions import fiber_direction as fiber_direction
from shading.directions import sin2_between as sin2_between
from shading.fuzz.ambient import ambient_attenuation as ambient_attenuation
from shading.fuzz.ambient import ambient_layer as ambient_layer
from shading.fuzz.ambient import ambient_layer_lit as ambient_layer_lit
from shading.fuzz.ambient import ambient_radiance as ambient_radiance
from shading.fuzz.ambient import lit_fraction as lit_fraction
from shading.fuzz.ambient_models import AMBIENT_MODELS as AMBIENT_MODELS
from shading.fuzz.ambient_models import AmbientModel as AmbientModel
from shading.fuzz.brdf import asymmetry_from_spread as asymmetry_from_spread
from shading.fuzz.brdf import base_attenuation as base_attenuation
from shading.fuzz.brdf import escape as escape
from shading.fuzz.brdf import layer_brdf as layer_brdf
from shading.fuzz.brdf import roughness_from_spread as roughness_from_spread
from shading.fuzz.deferred import deferred_radiance as deferred_radiance
from shading.fuzz.deferred import wrapped_cosine as wrapped_cosine
from shading.fuzz.layer import optical_path as optical_path
from shading.fuzz.layer import penetration as penetration
from shading.fuzz.layer import scattering_kernel as scattering_kernel
from shading.fuzz.layer_light import LayerLight as LayerLight
from shading.fuzz.layer_light import LayerView as LayerView
from shading.fuzz.layer_light import layer_radiance as layer_radiance
from shading.fuzz.layer_light import light_weights as light_weights
from shading.fuzz.lit_moments import LitMoments as LitMoments
from shading.fuzz.lit_moments import lit_moments as lit_moments
from shading.fuzz.phase import fiber_phase_function as fiber_phase_function
from shading.fuzz.phase import reciprocal_phase_function as reciprocal_phase_function
from shading.fuzz.phase import reciprocal_scale as reciprocal_scale
from shading.fuzz.phase import velvet_lobe as velvet_lobe
from shading.fuzz.phase import velvet_phase_function as velvet_phase_function
from shading.harmonics import harmonics as harmonics
from shading.harmonics import irradiance as irradiance
from shading.harmonics import mean_radiance as mean_radiance
from shading.harmonics import radiance as radiance
from shading.phase import half_vector as half_vector
from shading.phase import phase_function as phase_function
from shading.phase import schlick_phase_function as schlick_phase_function
from shading.sampling import sample_phase_function as sample_phase_function
from shading.sggx import fiber_matrix as fiber_matrix
from shading.sggx import fiber_normal_distribution as fiber_normal_distribution
from shading.sggx import fiber_projected_area as fiber_projected_area
from shading.sggx import fiber_root as fiber_root
from shading.sggx import normal_distribution as normal_distribution
from shading.sggx import projected_area as projected_area
from shading.sggx import reflect as reflect
from shading.sggx import sample_visible_normal as sample_visible_normal
from shading.sggx import visible_normal as visible_normal
