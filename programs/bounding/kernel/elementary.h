/* Elementary functions of intervals and jets, by series whose remainders are bounded.

   No function of the C library is used: its errors are not stated for upward rounding. The series
   are evaluated in interval arithmetic. Each begins with an interval that contains the terms that
   are left out, over the last one. */

#define LN2_FIRST 0x1.62e42feep-1
#define LN2_REST between(0x1.a39ef35793c76p-33, 0x1.a39ef35793c77p-33)
#define LN2 between(0x1.62e42fefa39efp-1, 0x1.62e42fefa39f0p-1)
#define HALF_PI_FIRST 0x1.921fb544p+0
#define HALF_PI_SECOND 0x1.0b4611a6p-34
#define HALF_PI_REST between(0x1.3198a2e037073p-69, 0x1.3198a2e037074p-69)
#define HALF_PI between(0x1.921fb54442d18p+0, 0x1.921fb54442d19p+0)
/* A sum with this number is rounded up to a whole number. */
#define WHOLE 0x1.8p52

INLINE V as_real(M a) { return __builtin_convertvector(a, V); }
INLINE M as_whole(V a) { return __builtin_convertvector(a, M); }
INLINE V vfloor(V x) {
    V t = as_real(as_whole(x));
    return t - pick(t > x, all(1), all(0));
}
INLINE V vceil(V x) {
    V t = as_real(as_whole(x));
    return t + pick(t < x, all(1), all(0));
}
/* The whole number that is nearest to x, but for rounding, while the processor rounds upward */
INLINE V nearest(V x) { return ((x - 0.5) + WHOLE) - WHOLE; }
INLINE iv idivide(iv a, double k) { return (iv){a.n / k, a.h / k}; }
INLINE iv over_odd(int k) { return pdiv(number(1), number(k)); }

/* e^r for |r| <= 0.36 without the first `skip` terms over r^skip (skip is 0 or 1) */
static inline iv exp_series(iv r, int skip) {
    iv p = between(0.97, 1.03);
    for (int j = 17; j > skip; --j) p = iadd(number(1), idivide(imul(r, p), j));
    return p;
}
static iv exp_at(boxes *K, V x) {
    M fine = (x >= -DBL_MAX) & (x < 700), tiny = x <= -700;
    K->bad |= ~fine;
    x = pick(fine & ~tiny, x, all(0));
    V k = nearest(x * 0x1.71547652b82fep+0);
    iv r = isub(isub(point(x), point(k * LN2_FIRST)), iscale(LN2_REST, k));
    iv p = exp_series(r, 0);
    V power = (V)((as_whole(k) + 1023) << 52);
    /* e^-700 < 2^-1009 */
    return ipick(tiny, between(0, 0x1p-1009), (iv){p.n * power, p.h * power});
}
static iv expm1_at(boxes *K, V x) {
    M small = (x > -0.35) & (x < 0.35);
    V s = pick(small, x, all(0));
    iv near = imul(point(s), exp_series(point(s), 1));
    return ipick(small, near, isub(exp_at(K, x), number(1)));
}
/* 2 artanh(s) for |s| <= 0.1716 */
static inline iv log_series(iv s) {
    iv z = isquare(s), q = between(0.034, 0.036);
    for (int j = 13; j >= 0; --j) q = iadd(over_odd(2 * j + 1), imul(z, q));
    return iscale(imul(s, q), all(2));
}
static iv log_at(boxes *K, V x) {
    M fine = (x >= DBL_MIN) & (x <= DBL_MAX);
    K->bad |= ~fine;
    x = pick(fine, x, all(1));
    M bits = (M)x, e = (bits >> 52) - 1023;
    V m = (V)((bits & 0xfffffffffffffLL) | (1023LL << 52));
    M big = m > 1.4142;
    m = pick(big, m * 0.5, m);
    iv s = imul(point(m - 1), ireciprocal(iadd(point(m), number(1))));
    return iadd(iscale(LN2, as_real(e - big)), log_series(s));
}
/* log1p(x) = 2 artanh(x/(2 + x)) near zero */
static iv log1p_at(boxes *K, V x) {
    M small = (x > -0.28) & (x < 0.4);
    V s = pick(small, x, all(0));
    iv near = log_series(imul(point(s), ireciprocal(iadd(number(2), point(s)))));
    iv sum = iadd(number(1), point(pick(small, all(0), x)));
    iv far = {log_at(K, -sum.n).n, log_at(K, sum.h).h};
    return ipick(small, near, far);
}
/* The tail is that of 1/29 − z/31 + … */
static inline iv atan_at(boxes *K, V x) {
    M fine = (x > -1e150) & (x < 1e150);
    K->bad |= ~fine;
    iv t = point(pick(fine, x, all(0))), one = number(1);
    for (int i = 0; i < 3; ++i)
        t = imul(t, ireciprocal(iadd(one, isqrt(iadd(one, isquare(t))))));
    iv z = isquare(t), q = between(0.033, 0.0346);
    for (int j = 13; j >= 0; --j) q = isub(over_odd(2 * j + 1), imul(z, q));
    return iscale(imul(t, q), all(8));
}
static iv asin_at(boxes *K, V x) {
    M fine = (x >= -1) & (x <= 1);
    K->bad |= ~fine;
    x = pick(fine, x, all(0));
    iv one = number(1), s = point(x);
    iv c = isqrt(imul(isub(one, s), iadd(one, s)));
    iv t = imul(s, ireciprocal(iadd(one, c)));
    return iscale((iv){atan_at(K, -t.n).n, atan_at(K, t.h).h}, all(2));
}
static iv cos_at(boxes *K, V x) {
    M fine = (x > -1000) & (x < 1000);
    K->bad |= ~fine;
    x = pick(fine, x, all(0));
    V k = nearest(x * 0x1.45f306dc9c883p-1);
    iv r = isub(isub(point(x), point(k * HALF_PI_FIRST)), point(k * HALF_PI_SECOND));
    r = isub(r, iscale(HALF_PI_REST, k));
    iv z = isquare(r), s = between(0.99, 1.0), c = s, one = number(1);
    for (int j = 10; j > 0; --j) {
        s = isub(one, idivide(imul(z, s), 2 * j * (2 * j + 1)));
        c = isub(one, idivide(imul(z, c), 2 * j * (2 * j - 1)));
    }
    s = imul(r, s);
    M q = as_whole(k) & 3;
    iv even = ipick(q == 0, c, ineg(c)), odd = ipick(q == 3, s, ineg(s));
    return ipick((q & 1) == 0, even, odd);
}
static iv cos_range(boxes *K, iv a) {
    iv bounds = ihull(cos_at(K, -a.n), cos_at(K, a.h));
    /* Extreme values are at multiples of pi. The margin is far above rounding for |a| < 1000. */
    V over_pi = all(0x1.45f306dc9c883p-2);
    V first = vceil(-a.n * over_pi - 1e-12), last = vfloor(a.h * over_pi + 1e-12);
    M both = last - first >= 1, one = last == first, odd = (as_whole(first) & 1) != 0;
    bounds.h = pick(both | (one & ~odd), all(1), vmin(bounds.h, all(1)));
    bounds.n = pick(both | (one & odd), all(1), vmin(bounds.n, all(1)));
    return bounds;
}
static iv sin_range(boxes *K, iv a) { return cos_range(K, isub(a, HALF_PI)); }

/* A function that rises, of an interval */
#define RISING(at, a) ((iv){at(K, -(a).n).n, at(K, (a).h).h})

static jet jexp(boxes *K, jet a) {
    iv v = RISING(exp_at, a.v);
    return chain(K, a, v, RISING(exp_at, a.c), v);
}
static jet jexpm1(boxes *K, jet a) {
    iv v = RISING(expm1_at, a.v);
    return chain(K, a, v, RISING(expm1_at, a.c), iadd(v, number(1)));
}
static jet jlog(boxes *K, jet a) {
    return chain(K, a, RISING(log_at, a.v), RISING(log_at, a.c), ireciprocal(a.v));
}
static jet jlog1p(boxes *K, jet a) {
    iv slope = ireciprocal(iadd(number(1), a.v));
    K->bad |= ~(a.v.n < 1);
    return chain(K, a, RISING(log1p_at, a.v), RISING(log1p_at, a.c), slope);
}
static jet jatan(boxes *K, jet a) {
    iv slope = ireciprocal(iadd(number(1), isquare(a.v)));
    return chain(K, a, RISING(atan_at, a.v), RISING(atan_at, a.c), slope);
}
static jet jasin(boxes *K, jet a) {
    iv one = number(1), cosine = isqrt(imul(isub(one, a.v), iadd(one, a.v)));
    return chain(K, a, RISING(asin_at, a.v), RISING(asin_at, a.c), ireciprocal(cosine));
}
static jet jcos(boxes *K, jet a) {
    return chain(K, a, cos_range(K, a.v), cos_range(K, a.c), ineg(sin_range(K, a.v)));
}
static jet jsin(boxes *K, jet a) {
    return chain(K, a, sin_range(K, a.v), sin_range(K, a.c), cos_range(K, a.v));
}
/* A step function: where it jumps, slopes have no bound. */
static jet step(boxes *K, jet a, iv v, iv c) {
    M still = -v.n == v.h;
    iv slope = ipick(still, number(0), between(-INFINITY, INFINITY));
    return chain(K, a, v, c, slope);
}
static jet jfloor(boxes *K, jet a) {
    M fine = within(a.v, -1e15, 1e15);
    K->bad |= ~fine;
    iv v = ipick(fine, a.v, number(0)), c = ipick(fine, a.c, number(0));
    iv floor_v = {-vfloor(-v.n), vfloor(v.h)}, floor_c = {-vfloor(-c.n), vfloor(c.h)};
    return step(K, a, floor_v, floor_c);
}
static inline jet constant(iv x) {
    jet y = {x, x, {}};
    for (int k = 0; k < NVAR; ++k) y.g[k] = number(0);
    return y;
}
static jet jpow(boxes *K, jet a, jet b) { return jexp(K, times(K, b, jlog(K, a))); }
/* a^y for a >= 0 and y > 0; 0 at a = 0 */
static iv pow_at(boxes *K, V a, double y) {
    M zero = a < DBL_MIN;
    iv log = log_at(K, pick(zero, all(DBL_MIN), a)), power = imul(log, number(y));
    iv p = {exp_at(K, -power.n).n, exp_at(K, power.h).h};
    p.n = pick(zero, all(0), p.n);
    p.h = pick(a <= 0, all(0), p.h);
    return p;
}
static iv pow_range(boxes *K, iv a, double y) {
    return (iv){pow_at(K, -a.n, y).n, pow_at(K, a.h, y).h};
}
static jet jpow_n(boxes *K, jet a, double y) {
    if (!(y > 0)) return jpow(K, a, lift(K, y));
    K->bad |= ~(a.v.n <= 0);
    V zero = all(0);
    iv v = pow_range(K, a.v, y), c = pow_range(K, imeet(a.c, (iv){zero, a.c.h}), y), slope;
    if (y > 1) slope = iscale(pow_range(K, a.v, y - 1), all(y));
    else slope = imul(imul(v, ireciprocal(a.v)), number(y));
    /* y - 1 may be rounded: its neighbours are as good. */
    if (y > 1) slope = ihull(slope, iscale(pow_range(K, a.v, (y - 1) * (1 - 0x1p-50)), all(y)));
    return chain(K, a, v, c, slope);
}
static jet jpow_nj(boxes *K, double a, jet b) { return jpow(K, lift(K, a), b); }
static jet jatan2(boxes *K, jet y, jet x) {
    K->bad |= ~(x.v.n < 0);
    return jatan(K, over(K, y, x));
}
static jet jsinh(boxes *K, jet a) {
    return scale(K, sub_jj(K, jexp(K, a), jexp(K, negative(K, a))), 0.5);
}
static jet jcosh(boxes *K, jet a) {
    return scale(K, add2(K, jexp(K, a), jexp(K, negative(K, a))), 0.5);
}
/* tanh x = 1 - 2/(e^2x + 1) */
static jet jtanh(boxes *K, jet a) {
    jet below = shift(K, jexp(K, scale(K, a, 2)), 1);
    return sub_nj(K, 1, inverse(K, 2, below));
}

#define EXP(a) jexp(K, a)
#define EXP2(a) jexp(K, times(K, a, constant(LN2)))
#define EXPM1(a) jexpm1(K, a)
#define LOG(a) jlog(K, a)
#define LOG1P(a) jlog1p(K, a)
#define COS(a) jcos(K, a)
#define SIN(a) jsin(K, a)
#define TAN(a) over(K, jsin(K, a), jcos(K, a))
#define ATAN(a) jatan(K, a)
#define ASIN(a) jasin(K, a)
#define ACOS(a) sub_jj(K, constant(HALF_PI), jasin(K, a))
#define ATAN2(a, b) jatan2(K, JET(a), JET(b))
#define POW(a, b) PAIR(a, b, jpow, jpow_n, jpow_nj)
#define SINH(a) jsinh(K, a)
#define COSH(a) jcosh(K, a)
#define TANH(a) jtanh(K, a)
#define FLOOR(a) jfloor(K, a)
#define CEIL(a) negative(K, jfloor(K, negative(K, a)))
