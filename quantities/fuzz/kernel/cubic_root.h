/* The root L of the cubic L (L - p) (L + r) = m (1 - L^2) in the closed form of P_s, as one operation.

   On [max(p, 0), 1] the left side minus the right side, f, rises in L. L rises with p and m, and
   falls with r. So the roots for the ends of p, r and m bound it. Each is found by Newton's method
   and then moved until the sign of f, in interval arithmetic, proves it.

   These are proven for all points of the domain (docs/closed-form.md, docs/range.md): p <= 1,
   c <= r, alpha^2 <= L <= 1, L >= p. */

/* A few steps to the root; the result is not proven. Rounding does not matter here. */
static V root_near(V p, V r, V m, V alpha2) {
    V half = p * 0.5, frozen = r + half + vsqrt(half * half + 0.42 * alpha2);
    V h = half * frozen, below = frozen + m;
    V x = (h + vsqrt(h * h + m * below)) / below, a = m + r - p, e = p * r;
    for (int i = 0; i < 5; ++i) {
        V product = (x + a) * x, rising = x * x + product;
        x = (rising * x + m) / (rising + product - e);
    }
    return x;
}
INLINE iv not_negative(iv a) { return (iv){vmin(a.n, all(0)), vmax(a.h, all(0))}; }
INLINE iv one_minus_square(iv x) {
    iv one = number(1);
    return not_negative(imul(isub(one, x), iadd(one, x)));
}
/* x (x - p) (x + r), with x - p cut at zero; and m (1 - x^2) */
INLINE iv left_side(V x, V p, V r) {
    iv gap = not_negative(isub(point(x), point(p)));
    return pmul(pmul(point(x), gap), not_negative(iadd(point(x), point(r))));
}
INLINE iv right_side(V x, V m) { return pmul(point(m), one_minus_square(point(x))); }

/* An upper bound of the root: f >= 0 there. f(1) >= 0 because p <= 1. */
static V root_above(V p, V r, V m, V alpha2) {
    V one = all(1), x = root_near(p, r, m, alpha2) * (1 + 0x1p-49);
    M proven = (x >= p) & (x > 0) & (x <= 1) & (-left_side(x, p, r).n >= right_side(x, m).h);
    return pick(proven, x, one);
}
/* A lower bound of the root: f <= 0 there. f(max(p, 0)) <= 0. */
static V root_below(V p, V r, V m, V alpha2) {
    V zero = all(0), x = root_near(p, r, m, alpha2) * (1 - 0x1p-49), trivial = vmax(p, zero);
    M proven = (x >= 0) & (x <= 1) & (left_side(x, p, r).h <= -right_side(x, m).n);
    return vmax(pick(proven, x, trivial), trivial);
}
INLINE iv root_of(iv p, iv r, iv m, V alpha2) {
    return (iv){-root_below(-p.n, r.h, -m.n, alpha2), root_above(p.h, -r.n, m.h, alpha2)};
}
/* part/(part + rest) for what is not negative */
INLINE iv share(iv part, iv rest) {
    iv least = pdiv((iv){part.n, -part.n}, iadd((iv){part.n, -part.n}, (iv){-rest.h, rest.h}));
    iv most = pdiv((iv){-part.h, part.h}, iadd((iv){-part.h, part.h}, (iv){rest.n, -rest.n}));
    V zero = all(0), one = all(1);
    return (iv){-pick(-part.n > zero, -least.n, zero), pick(most.h < one, most.h, one)};
}
/* m (1 - L^2) / (L (L + r)), which is L - p */
INLINE iv gap_of(iv l, iv r, iv m) {
    iv below = pmul(l, iadd(l, r)), w = pdiv(pmul(m, one_minus_square(l)), below);
    return ipick(-below.n > 0, w, between(0, INFINITY));
}
INLINE jet combine(boxes *K, iv v, iv c, jet p, iv by_p, jet r, iv by_r, jet m, iv by_m) {
    jet y = {v, c, {}};
    for (int k = 0; k < NVAR; ++k)
        y.g[k] = iadd(iadd(imul(p.g[k], by_p), imul(r.g[k], by_r)), imul(m.g[k], by_m));
    return settle(K, y);
}
/* Cut values to what is proven for the whole domain */
INLINE jet at_least_jet(jet a, jet least) {
    a.v.n = vmin(a.v.n, least.v.n);
    return a;
}
INLINE jet limited(jet a, double low, double high) {
    a.v = imeet(a.v, between(low, high));
    return a;
}

/* The root and its distance from p. The slopes are those of the implicit equation. They hold for all
   p, r and m between their bounds, so no bound is used there that holds on the domain only. */
static void cubic_root(boxes *K, jet p, jet r, jet m, jet alpha2, jet *root, jet *gap) {
    V about = alpha2.c.h;
    iv any = root_of(p.v, r.v, m.v, about), centre = root_of(p.c, r.c, m.c, about);
    iv w = not_negative(imeet(isub(any, p.v), gap_of(any, r.v, m.v)));
    iv sum = iadd(any, r.v), a = pmul(w, sum), b = pmul(any, sum), c = pmul(any, w);
    iv d = iscale(pmul(m.v, any), all(2)), rest = iadd(iadd(a, c), d);
    iv slope = iadd(b, rest);
    K->bad |= ~(-slope.n > 0);
    iv by_p = share(b, rest), by_r = ineg(share(c, iadd(iadd(a, b), d)));
    iv by_m = pdiv(one_minus_square(any), slope), away = ineg(share(rest, b));
    iv proven = any;
    proven.n = vmin(proven.n, alpha2.v.n);
    centre.n = vmin(centre.n, alpha2.c.n);
    iv w_proven = not_negative(imeet(w, gap_of(proven, r.v, m.v)));
    iv w_centre = not_negative(imeet(isub(centre, p.c), gap_of(centre, r.c, m.c)));
    *root = combine(K, proven, centre, p, by_p, r, by_r, m, by_m);
    *gap = combine(K, w_proven, w_centre, p, away, r, by_r, m, by_m);
    *gap = limited(*gap, 0, 2);
}
/* The cubic for alpha^2, kappa, a = u.t, b = n.t and c = u.n in g. Returns sigma_u^2 and sigma_n^2 in
   s, p, r and m in f, the root, and its distance from p. The functions `sizes` and `factors` are
   printed before this file. Values, here and in g, are cut to bounds that are proven for the whole
   domain: |a| <= 1, alpha^2 <= sigma^2 <= 1, c <= r, p <= 1 (docs/range.md, docs/closed-form.md). */
static void cubic_at(boxes *K, jet *g, jet *s, jet *f, jet *root, jet *gap) {
    g[2] = limited(g[2], -1, 1);
    g[4] = limited(g[4], 0, 1);
    sizes(K, g[0], g[1], g[2], g[3], g[4], s);
    s[0] = limited(at_least_jet(s[0], g[0]), 0, 1);
    s[1] = limited(at_least_jet(s[1], g[0]), 0, 1);
    factors(K, g[0], g[1], g[2], g[3], g[4], s[0], s[1], f);
    f[0] = limited(f[0], -1, 1);
    f[1] = limited(at_least_jet(f[1], g[4]), 0, 2);
    f[2] = limited(f[2], 0, 1);
    cubic_root(K, f[0], f[1], f[2], g[0], root, gap);
}
