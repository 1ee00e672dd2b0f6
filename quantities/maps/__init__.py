"""The quantities of filtered maps: the widening of the best lobe, even and along axes."""

from quantities.maps.filtered_width import SGGX_FILTER as SGGX_FILTER
from quantities.maps.filtered_width import SGGX_FILTER_AXES as SGGX_FILTER_AXES
