/* Interval arithmetic on eight boxes at once, with slopes.

   Every function here must run while the processor rounds upward. A lower bound is stored as its
   negative, so that upward rounding moves both bounds outward. A `jet` holds, for each box, an
   interval that contains all values of an expression on the box (v), one that contains the value at
   the box's centre (c), and one for each variable that contains all slopes (g):
   value(x) - value(centre) is in the sum of g[k] (x[k] - centre[k]).

   Slopes need no derivative. A condition that holds on a part of a box only is not decided: the
   program is evaluated for both cases, each on the whole box, and the results are united. This is
   right also where the program jumps.

   NVAR, the number of variables, is defined before this file. */
#include <float.h>
#define INFINITY __builtin_inf()

typedef double V __attribute__((vector_size(64)));
typedef long long M __attribute__((vector_size(64)));

/* Code that is inlined everywhere runs faster, but takes long to compile. */
#ifdef INLINE_ALL
#define INLINE static inline __attribute__((always_inline))
#else
#define INLINE static inline
#endif
#define UNUSED __attribute__((unused))

/* An interval: minus the lower bound, and the upper bound. */
typedef struct { V n, h; } iv;
typedef struct { iv v, c, g[NVAR]; } jet;
/* A condition: the boxes on which it holds everywhere, and on which it holds nowhere. */
typedef struct { M yes, no; } truth;
/* What is known of the boxes: half the width in each variable; `bad`, where an expression may be
   undefined or overflow; `flat`, where slopes have no bound, so that they are not used; `open`, a
   bit for each condition that some box does not decide; `assumed`, a bit for each such condition
   that is taken to hold. */
typedef struct { V r[NVAR]; M bad, flat; unsigned long long open, assumed; } boxes;

INLINE V all(double x) { return (V){x, x, x, x, x, x, x, x}; }
INLINE V pick(M m, V a, V b) { return (V)(((M)a & m) | ((M)b & ~m)); }

#ifdef __AVX512F__
#include <immintrin.h>
INLINE V vmax(V a, V b) { return (V)_mm512_max_pd((__m512d)a, (__m512d)b); }
INLINE V vmin(V a, V b) { return (V)_mm512_min_pd((__m512d)a, (__m512d)b); }
INLINE V vsqrt(V a) { return (V)_mm512_sqrt_pd((__m512d)a); }
#else
INLINE V vmax(V a, V b) { return pick(a > b, a, b); }
INLINE V vmin(V a, V b) { return pick(a < b, a, b); }
INLINE V vsqrt(V a) {
    for (int i = 0; i < 8; ++i) a[i] = __builtin_sqrt(a[i]);
    return a;
}
#endif

/* Interval arithmetic */

INLINE iv point(V x) { return (iv){-x, x}; }
INLINE iv number(double x) { return point(all(x)); }
INLINE iv between(double lower, double upper) { return (iv){all(-lower), all(upper)}; }
INLINE iv iadd(iv a, iv b) { return (iv){a.n + b.n, a.h + b.h}; }
INLINE iv isub(iv a, iv b) { return (iv){a.n + b.h, a.h + b.n}; }
INLINE iv ineg(iv a) { return (iv){a.h, a.n}; }
INLINE iv imul(iv a, iv b) {
    V an = -a.n, ah = -a.h;
    return (iv){
        vmax(vmax(an * b.n, a.n * b.h), vmax(a.h * b.n, ah * b.h)),
        vmax(vmax(a.n * b.n, an * b.h), vmax(ah * b.n, a.h * b.h)),
    };
}
INLINE iv iscale(iv a, V s) {
    V an = -a.n, ah = -a.h;
    return (iv){vmax(a.n * s, ah * s), vmax(an * s, a.h * s)};
}
/* Products and quotients of what is not negative */
INLINE iv pmul(iv a, iv b) { return (iv){-a.n * b.n, a.h * b.h}; }
INLINE iv pdiv(iv a, iv b) { return (iv){a.n / b.h, a.h / -b.n}; }
INLINE iv ihull(iv a, iv b) { return (iv){vmax(a.n, b.n), vmax(a.h, b.h)}; }
INLINE iv imeet(iv a, iv b) { return (iv){vmin(a.n, b.n), vmin(a.h, b.h)}; }
INLINE iv ipick(M m, iv a, iv b) { return (iv){pick(m, a.n, b.n), pick(m, a.h, b.h)}; }
INLINE iv iabs(iv a) {
    V zero = all(0), least = vmax(vmax(-a.n, -a.h), zero);
    return (iv){-least, vmax(a.n, a.h)};
}
INLINE iv isquare(iv a) {
    iv s = iabs(a);
    return (iv){s.n * -s.n, s.h * s.h};
}
/* 1/a for an interval without zero; its bounds are infinite or NaN otherwise. */
INLINE iv ireciprocal(iv a) {
    M fine = (a.n < 0) | (a.h < 0);
    iv y = {all(-1) / a.h, all(-1) / a.n};
    return ipick(fine, y, between(-INFINITY, INFINITY));
}
/* The root of a, whose part below zero is left out. With s >= sqrt(x), x/s is a lower bound. */
INLINE iv isqrt(iv a) {
    V zero = all(0), low = vmax(-a.n, zero), high = vmax(a.h, zero);
    V s = vsqrt(low);
    return (iv){pick(low > zero, -low / s, zero), vsqrt(high)};
}
INLINE M bounded(iv a) { return (a.n < DBL_MAX) & (a.h < DBL_MAX); }
INLINE M within(iv a, double low, double high) { return (-a.n >= low) & (a.h <= high); }

/* Jets */

INLINE V largest(iv a) { return vmax(a.n, a.h); }

/* Note undefined values and slopes without bound; cut the value to what the slopes allow. */
INLINE jet settle(boxes *K, jet x) {
    V spread = all(0);
    for (int k = 0; k < NVAR; ++k) spread += largest(x.g[k]) * K->r[k];
    /* A comparison with NaN is false. */
    K->bad |= ~(bounded(x.v) & bounded(x.c));
    K->flat |= ~(spread < DBL_MAX);
    V n = pick(K->flat, all(INFINITY), x.c.n + spread);
    V h = pick(K->flat, all(INFINITY), x.c.h + spread);
    x.v.n = vmin(n, x.v.n);
    x.v.h = vmin(h, x.v.h);
    return x;
}
INLINE jet lift(boxes *K UNUSED, double x) {
    jet y;
    y.v = y.c = number(x);
    for (int k = 0; k < NVAR; ++k) y.g[k] = number(0);
    return y;
}
INLINE jet same(boxes *K UNUSED, jet x) { return x; }
#define JET(x) (_Generic((x), double: lift, jet: same)(K, x))

INLINE jet add2(boxes *K, jet a, jet b) {
    jet y = {iadd(a.v, b.v), iadd(a.c, b.c), {}};
    for (int k = 0; k < NVAR; ++k) y.g[k] = iadd(a.g[k], b.g[k]);
    return settle(K, y);
}
INLINE jet shift(boxes *K, jet a, double b) {
    iv s = number(b);
    a.v = iadd(a.v, s);
    a.c = iadd(a.c, s);
    return settle(K, a);
}
INLINE jet negative(boxes *K UNUSED, jet a) {
    jet y = {ineg(a.v), ineg(a.c), {}};
    for (int k = 0; k < NVAR; ++k) y.g[k] = ineg(a.g[k]);
    return y;
}
INLINE jet scale(boxes *K, jet a, double b) {
    V s = all(b);
    jet y = {iscale(a.v, s), iscale(a.c, s), {}};
    for (int k = 0; k < NVAR; ++k) y.g[k] = iscale(a.g[k], s);
    return settle(K, y);
}
INLINE jet times(boxes *K, jet a, jet b) {
    jet y = {imul(a.v, b.v), imul(a.c, b.c), {}};
    for (int k = 0; k < NVAR; ++k)
        y.g[k] = iadd(imul(a.g[k], b.v), imul(b.g[k], a.c));
    return settle(K, y);
}
INLINE jet square(boxes *K, jet a) {
    jet y = {isquare(a.v), isquare(a.c), {}};
    iv sum = iadd(a.v, a.c);
    for (int k = 0; k < NVAR; ++k) y.g[k] = imul(a.g[k], sum);
    return settle(K, y);
}
/* a/b - A/B = ((a - A) - (A/B) (b - B)) / b */
INLINE jet over(boxes *K, jet a, jet b) {
    iv i = ireciprocal(b.v);
    jet y = {imul(a.v, i), imul(a.c, ireciprocal(b.c)), {}};
    K->bad |= ~bounded(i);
    for (int k = 0; k < NVAR; ++k)
        y.g[k] = imul(isub(a.g[k], imul(y.c, b.g[k])), i);
    return settle(K, y);
}
INLINE jet inverse(boxes *K, double a, jet b) {
    iv i = ireciprocal(b.v), s = number(a);
    jet y = {imul(s, i), imul(s, ireciprocal(b.c)), {}};
    K->bad |= ~bounded(i);
    iv t = ineg(imul(y.c, i));
    for (int k = 0; k < NVAR; ++k) y.g[k] = imul(t, b.g[k]);
    return settle(K, y);
}
/* A function of an interval: its values, its value at the centre, and bounds of its slope */
INLINE jet chain(boxes *K, jet a, iv value, iv centre, iv slope) {
    jet y = {value, centre, {}};
    M fine = bounded(slope);
    K->flat |= ~fine;
    slope = ipick(fine, slope, number(0));
    for (int k = 0; k < NVAR; ++k) y.g[k] = imul(a.g[k], slope);
    return settle(K, y);
}
/* sqrt(a) - sqrt(A) = (a - A) / (sqrt(a) + sqrt(A)) */
INLINE jet root(boxes *K, jet a) {
    iv v = isqrt(a.v), c = isqrt(a.c);
#ifndef ROOTS_ARE_DEFINED
    K->bad |= ~(a.v.n <= 0);
#endif
    return chain(K, a, v, c, ireciprocal(iadd(v, c)));
}
INLINE jet magnitude(boxes *K, jet a) {
    V one = all(1);
    iv slope = {pick(a.v.n <= 0, -one, one), pick(a.v.h < 0, -one, one)};
    return chain(K, a, iabs(a.v), iabs(a.c), slope);
}
INLINE jet blend(boxes *K UNUSED, M yes, M no, jet a, jet b, iv value, iv centre) {
    jet y;
    y.v = ipick(yes, a.v, ipick(no, b.v, value));
    y.c = ipick(yes, a.c, ipick(no, b.c, centre));
    for (int k = 0; k < NVAR; ++k)
        y.g[k] = ipick(yes, a.g[k], ipick(no, b.g[k], ihull(a.g[k], b.g[k])));
    return y;
}
INLINE jet larger(boxes *K, jet a, jet b) {
    M yes = -a.v.n >= b.v.h, no = -b.v.n >= a.v.h;
    iv v = {vmin(a.v.n, b.v.n), vmax(a.v.h, b.v.h)}, c = {vmin(a.c.n, b.c.n), vmax(a.c.h, b.c.h)};
    return settle(K, blend(K, yes, no & ~yes, a, b, v, c));
}
INLINE jet smaller(boxes *K, jet a, jet b) {
    M yes = a.v.h <= -b.v.n, no = b.v.h <= -a.v.n;
    iv v = {vmax(a.v.n, b.v.n), vmin(a.v.h, b.v.h)}, c = {vmax(a.c.n, b.c.n), vmin(a.c.h, b.c.h)};
    return settle(K, blend(K, yes, no & ~yes, a, b, v, c));
}
INLINE jet choose(boxes *K, truth which, jet a, jet b) {
    return settle(
        K, blend(K, which.yes, which.no, a, b, ihull(a.v, b.v), ihull(a.c, b.c)));
}
INLINE truth lt2(jet a, jet b) { return (truth){a.v.h < -b.v.n, -a.v.n >= b.v.h}; }
INLINE truth le2(jet a, jet b) { return (truth){a.v.h <= -b.v.n, -a.v.n > b.v.h}; }
INLINE truth eq2(jet a, jet b) {
    M one = (-a.v.n == a.v.h) & (-b.v.n == b.v.h) & (a.v.h == b.v.h);
    return (truth){one, (a.v.h < -b.v.n) | (-a.v.n > b.v.h)};
}
/* Decide a condition by assumption where the box does not decide it. */
INLINE truth decide(boxes *K, int number, truth t) {
    M open = ~(t.yes | t.no);
    int any = 0;
    for (int i = 0; i < 8; ++i) any |= open[i] != 0;
    if (any) {
        K->open |= 1ULL << number;
        if (K->assumed >> number & 1) t.yes |= open;
        else t.no |= open;
    }
    return t;
}
INLINE truth not1(truth a) { return (truth){a.no, a.yes}; }
INLINE truth and2(truth a, truth b) { return (truth){a.yes & b.yes, a.no | b.no}; }
INLINE truth or2(truth a, truth b) { return (truth){a.yes | b.yes, a.no & b.no}; }

/* The operations of a printed program. Every operand is a name or a number, so that equal text
   means equal values: x·x is a square, whose bounds are tighter than those of a product. */
INLINE jet add_jn(boxes *K, jet a, double b) { return shift(K, a, b); }
INLINE jet add_nj(boxes *K, double a, jet b) { return shift(K, b, a); }
INLINE jet sub_jj(boxes *K, jet a, jet b) { return add2(K, a, negative(K, b)); }
INLINE jet sub_jn(boxes *K, jet a, double b) { return shift(K, a, -b); }
INLINE jet sub_nj(boxes *K, double a, jet b) { return shift(K, negative(K, b), a); }
INLINE jet mul_nj(boxes *K, double a, jet b) { return scale(K, b, a); }
INLINE jet div_jn(boxes *K, jet a, double b) { return over(K, a, lift(K, b)); }
#define PAIR(a, b, jj, jn, nj) \
    (_Generic((a), double: nj, jet: _Generic((b), double: jn, jet: jj))(K, a, b))
#define ADD(a, b) PAIR(a, b, add2, add_jn, add_nj)
#define SUB(a, b) PAIR(a, b, sub_jj, sub_jn, sub_nj)
#define MUL(a, b) \
    (__builtin_strcmp(#a, #b) == 0 ? square(K, JET(a)) : PAIR(a, b, times, scale, mul_nj))
#define DIV(a, b) PAIR(a, b, over, div_jn, inverse)
#define NEG(a) negative(K, a)
#define ABS(a) magnitude(K, a)
#define SQRT(a) root(K, a)
#define RSQRT(a) inverse(K, 1.0, root(K, a))
#define MAX(a, b) larger(K, JET(a), JET(b))
#define MIN(a, b) smaller(K, JET(a), JET(b))
#define SELECT(t, a, b) choose(K, t, JET(a), JET(b))
/* Conditions are numbered in the order of the text. */
#define DECIDE(t) decide(K, __COUNTER__, t)
#define LT(a, b) DECIDE(lt2(JET(a), JET(b)))
#define LE(a, b) DECIDE(le2(JET(a), JET(b)))
#define GT(a, b) DECIDE(lt2(JET(b), JET(a)))
#define GE(a, b) DECIDE(le2(JET(b), JET(a)))
#define EQ(a, b) DECIDE(eq2(JET(a), JET(b)))
#define NE(a, b) not1(DECIDE(eq2(JET(a), JET(b))))
#define AND(a, b) and2(a, b)
#define OR(a, b) or2(a, b)
#define NOT(a) not1(a)
