"""Maps of anisotropic roughness: how wide the best lobe of a footprint is, and the decoders."""

from quantities.maps.decoders import DECODERS as DECODERS
from quantities.maps.filtered_width import SGGX_FILTER as SGGX_FILTER
from quantities.maps.filtered_width import SGGX_FILTER_AXES as SGGX_FILTER_AXES
