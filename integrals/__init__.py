"""Exact values of shading integrals, each by several independent methods.

A `Reference` is a quantity with its axes and its methods, which are called legs: a closed form,
quadrature and Monte Carlo, as far as they exist. All legs need float64, take scalars, and work
under `jax.jit` and `jax.vmap`. The closed form and the quadrature also work under `jax.grad`.

Tests compare the legs with each other, so it matters what they have in common. All legs use the
functions of `shading` that define the quantity, and the checks in `reference.leg`. Otherwise:

* P_s and Q: the legs share nothing else. Monte Carlo for P_s evaluates no density. It draws visible
  normals, and tests/shading/test_sggx.py holds these to the density that the quadrature integrates.
* G: all legs take the limits at d = 0 and ν = 0 from one function (`fuzz.g._with_limits`), so they
  cannot check each other there. They share nothing else.
* R: the quadrature averages the closed form of P_s, so it is only as good as that. Monte Carlo does
  not use it. tests/integrals/test_r.py also averages the quadrature of P_s.
* r(k), `VELVET`: all legs evaluate the energy for light at a right angle to the fibre, where
  docs/brdf.md proves it to be largest. `fuzz.velvet.scattered_energy` checks other lights.

`sources` makes references for quantities of your own. Its `monte_carlo` is imported from there:
here the name is that of a module.
"""

from integrals.fuzz.g import G as G
from integrals.fuzz.ps import PS as PS
from integrals.fuzz.q import Q as Q
from integrals.fuzz.r import R as R
from integrals.fuzz.velvet import VELVET as VELVET
from integrals.maps.references import SGGX_FILTER as SGGX_FILTER
from integrals.maps.references import SGGX_FILTER_AXES as SGGX_FILTER_AXES
from integrals.microfacet.references import GGX_AVERAGE_ALBEDO as GGX_AVERAGE_ALBEDO
from integrals.microfacet.references import GGX_BIAS as GGX_BIAS
from integrals.microfacet.references import GGX_DIRECTIONAL_ALBEDO as GGX_DIRECTIONAL_ALBEDO
from integrals.microfacet.references import GGX_SCALE as GGX_SCALE
from integrals.reference import Axis as Axis
from integrals.reference import Estimate as Estimate
from integrals.reference import Reference as Reference
from integrals.reference_of_source import make_reference as make_reference
from integrals.sampling import Sampling as Sampling
from integrals.skin.band_references import SKIN_BANDS as SKIN_BANDS
from integrals.skin.lobe_references import SKIN_LOBES as SKIN_LOBES
from integrals.skin.references import SKIN_REFERENCES as SKIN_REFERENCES
from integrals.sources import Source as Source
from integrals.sources import closed_form as closed_form
from integrals.sources import hemisphere as hemisphere
from integrals.sources import quadrature as quadrature
from integrals.sources import sphere as sphere

_FUZZ = (PS, G, Q, R, VELVET)
_MICROFACETS = (GGX_DIRECTIONAL_ALBEDO, GGX_SCALE, GGX_BIAS, GGX_AVERAGE_ALBEDO)
_MAPS = (SGGX_FILTER, SGGX_FILTER_AXES)
_SKIN = (*SKIN_REFERENCES, *SKIN_LOBES, *SKIN_BANDS)
REFERENCES = {each.name: each for each in (*_FUZZ, *_MICROFACETS, *_MAPS, *_SKIN)}
