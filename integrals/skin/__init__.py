"""Exact values of light that is scattered below curved skin.

`lobes` has one Gaussian on a ring and a sphere, by quadrature, `lobe_series` the same as Fourier and
Legendre series, and `sampling` the same by random points. `scattering` adds the Gaussians of a
profile up, and `harmonics` has the factors of light in spherical harmonics.
"""

from integrals.skin.harmonics import burley_harmonics as burley_harmonics
from integrals.skin.harmonics import harmonic_factors as harmonic_factors
from integrals.skin.harmonics import lobe_harmonics as lobe_harmonics
from integrals.skin.lobes import ring_lobe as ring_lobe
from integrals.skin.lobes import ring_mass as ring_mass
from integrals.skin.lobes import sphere_lobe as sphere_lobe
from integrals.skin.lobes import sphere_mass as sphere_mass
from integrals.skin.scattering import cylinder_scattering as cylinder_scattering
from integrals.skin.scattering import ring_weights as ring_weights
from integrals.skin.scattering import sphere_scattering as sphere_scattering
from integrals.skin.scattering import sphere_weights as sphere_weights
