"""Detail maps: operators f(s, d) that put a detail d onto a source s, and their inverses.

An operator maps [0, 1]² to [0, 1]. For every detail and every target t in [0, 1] there is a source
s in [0, 1] with f(s, d) = t, and the inverse returns it.
"""

from shading.detail.inverses import overlay_source as overlay_source
from shading.detail.inverses import smooth_overlay_source as smooth_overlay_source
from shading.detail.inverses import symmetric_overlay_source as symmetric_overlay_source
from shading.detail.operators import overlay as overlay
from shading.detail.operators import smooth_overlay as smooth_overlay
from shading.detail.operators import symmetric_overlay as symmetric_overlay
