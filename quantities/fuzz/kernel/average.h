/* 1 - R at a point: the average of 1 - P_s over lights, by a rule in two angles.

   The lights are c = u.n = sin^2 z and the azimuth phi. In z the interval from z_0 to pi/2 is divided
   into panels with the same rule; phi has the midpoint rule. What the rule leaves out is bounded in
   Python (r_bounds.py). Here only rounding matters: everything is an interval.

   This file follows the printed function `complement` and cubic_root.h. NVAR is 0: there are no
   slopes. */
#include <fenv.h>
#define MOST_AZIMUTHS 4096

static void round_upward(fenv_t *before);
static int rounds_upward(void);

/* middle + half cos((2 number + 1) pi / (2 count)), a Chebyshev node */
static iv chebyshev_node(boxes *K, const double *node) {
    iv angle = idivide(iscale(HALF_PI, all(2 * node[2] + 1)), node[3]);
    return iadd(number(node[0]), iscale(cos_range(K, angle), all(node[1])));
}
/* One lane for all lanes */
INLINE iv lane(iv a, int i) { return (iv){all(a.n[i]), all(a.h[i])}; }

/* 1 - P_s for eight azimuths; x = cos theta_f, cos theta_u = c, and the product of both sines. */
static iv goes_up(boxes *K, iv alpha2, iv kappa, iv b, iv c, iv sines, iv cos_phi) {
    jet j[5], s[2], f[3], root, gap;
    j[0] = constant(alpha2);
    j[1] = constant(kappa);
    j[2] = constant(iadd(imul(sines, cos_phi), imul(b, c)));
    j[3] = constant(b);
    j[4] = constant(c);
    cubic_at(K, j, s, f, &root, &gap);
    return complement(K, j[4], s[0], f[1], f[2], root, gap).v;
}

static void average(
    const double *alpha_node, const double *theta_node, const double *ends, long panels,
    const double *rule, long nodes, long azimuths, double *bounds) {
    boxes K;
    K.bad = K.flat = (M){0};
    K.open = K.assumed = 0;
    bounds[0] = -INFINITY;
    bounds[1] = INFINITY;
    if (!rounds_upward() || azimuths > MOST_AZIMUTHS || azimuths % 8 || nodes % 8) return;
    iv one = number(1), total = number(0), azimuth[MOST_AZIMUTHS / 8];
    iv alpha = chebyshev_node(&K, alpha_node), theta = chebyshev_node(&K, theta_node);
    iv alpha2 = isquare(alpha), kappa = imul(isub(one, alpha), iadd(one, alpha));
    iv b = cos_range(&K, theta), sin_f = sin_range(&K, theta);
    for (long k = 0; k < azimuths; k += 8) {
        V odd;
        for (int i = 0; i < 8; ++i) odd[i] = 2 * (k + i) + 1;
        azimuth[k / 8] = cos_range(&K, idivide(iscale(HALF_PI, odd), azimuths));
    }
    for (long panel = 0; panel < panels; ++panel) {
        iv low = number(ends[panel]);
        iv high = panel + 1 == panels ? HALF_PI : number(ends[panel + 1]);
        iv middle = iscale(iadd(low, high), all(0.5)), half = iscale(isub(high, low), all(0.5));
        for (long k = 0; k < nodes; k += 8) {
            V x, w;
            for (int i = 0; i < 8; ++i) x[i] = rule[k + i], w[i] = rule[nodes + k + i];
            iv z = iadd(middle, iscale(half, x));
            iv sine = sin_range(&K, z), cosine = cos_range(&K, z), c = isquare(sine);
            iv sines = imul(imul(cosine, isqrt(iadd(one, c))), sin_f);
            /* d(sin^4 z) = 4 sin^3 z cos z dz */
            iv weight = iscale(imul(imul(imul(c, sine), cosine), iscale(half, w)), all(4));
            for (int i = 0; i < 8; ++i) {
                iv sum = number(0), ci = lane(c, i), si = lane(sines, i);
                for (long j = 0; j < azimuths / 8; ++j)
                    sum = iadd(sum, goes_up(&K, alpha2, kappa, b, ci, si, azimuth[j]));
                total = iadd(total, imul(lane(weight, i), idivide(sum, azimuths)));
            }
        }
    }
    double below = 0, above = 0;
    for (int i = 0; i < 8; ++i) {
        if (K.bad[i]) return;
        below += total.n[i];
        above += total.h[i];
    }
    bounds[0] = -below;
    bounds[1] = above;
}
static void (*volatile hidden_average)(
    const double *, const double *, const double *, long, const double *, long, long, double *) =
    average;

/* alpha_node, theta_node: middle, half width, number and count of a Chebyshev node. ends: the lower
   ends of the panels. rule: nodes in [-1, 1], then their weights. bounds: the lower and upper one. */
void shadefit_average(
    const double *alpha_node, const double *theta_node, const double *ends, long panels,
    const double *rule, long nodes, long azimuths, double *bounds) {
    fenv_t before;
    round_upward(&before);
    hidden_average(alpha_node, theta_node, ends, panels, rule, nodes, azimuths, bounds);
    fesetenv(&before);
}

/* There is no search. */
static jet error_at(boxes *K, const jet *x UNUSED) { return lift(K, 0.0); }
