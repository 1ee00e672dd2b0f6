"""The quantities of filtered maps: how much wider the best lobe is, for an even spread and by axes."""

from quantities.maps.filtered_width import SGGX_FILTER as SGGX_FILTER
from quantities.maps.filtered_width import SGGX_FILTER_AXES as SGGX_FILTER_AXES
