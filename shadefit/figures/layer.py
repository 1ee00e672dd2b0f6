"""G over density and view, Q over density: surfaces, curves, and the tables' signed errors."""

import numpy as np
from matplotlib.figure import Figure

from integrals import G, Q
from shadefit.figures.maps import error_maps, surfaces
from shadefit.figures.style import COLOURS, DASHES, KINDS
from shadefit.figures.values import exact, exported, kind_of, mesh, tables_of

# The domain that the published tables were fitted on, and down to which the listings may be used.
DENSITY = (0.001, 0.5)
COS_V = (0.001, 1.0)


def draw_g() -> Figure:
    """Draw G over d and v·n: exact, published, refitted."""
    points = mesh(np.linspace(*DENSITY, 61), np.linspace(*COS_V, 61))
    return surfaces(G, points, ("density $d$", "$v·n$", "$G$"), (0.0, 1.0), azimuth=50.0)


def draw_g_errors() -> Figure:
    """Map G and the signed errors of its tables over d and v·n, both on logarithmic axes."""
    points = mesh(np.geomspace(*DENSITY, 121), np.geomspace(*COS_V, 121))
    return error_maps(G, points, ("density $d$", "$v·n$"), 0.1, logarithmic=True)


def draw_q() -> Figure:
    """Draw Q over d, exact and by every table, and below the tables' signed errors."""
    figure = Figure(figsize=(5.6, 5.0), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    density = np.linspace(0, DENSITY[1], 201)
    points = density[:, None]
    truth = exact(Q, points)
    above.plot(density, truth, color=COLOURS["exact"], label="exact, $2E_3(d)$")
    below.axhline(0, color=COLOURS["exact"], lw=0.8)
    drawn: set[str] = set()
    for name in tables_of("q"):
        kind = kind_of(name)
        label = None if kind in drawn else KINDS[kind]
        drawn.add(kind)
        values = exported(name, points)
        for axes, line in ((above, values), (below, values - truth)):
            axes.plot(
                density,
                line,
                label=label,
                color=COLOURS[kind],
                linestyle=DASHES[kind],
                # Of other forms there may be many: thin, and below the two that are compared.
                linewidth=0.9 if kind == "best" else 1.6,
                zorder=1 if kind == "best" else 2,
            )
    above.set(ylabel="$Q$, mean penetration", ylim=(0, 1.03))
    above.legend()
    below.set(xlabel="density $d$", ylabel="table − exact", xlim=(0, DENSITY[1]))
    return figure
