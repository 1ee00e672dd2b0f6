/* Values that float32 rounds, for bounds of the rounding error of a program (bounding/rounding.py).

   A rounded value is v (1 + d) + e with numbers d and e that are not known. An interval of a jet
   contains the value for all of them. Its slopes hold for each of them: they are the slopes of the
   value as a function of the variables, while d and e do not change. */

/* The smallest normal number of float32: smaller results may become zero. */
#define LEAST_NORMAL 0x1p-126
#define LARGEST_FLOAT 0x1.fffffep+127

/* A jet times an interval that does not depend on the variables */
static jet by_factor(jet a, iv factor) {
    a.v = imul(a.v, factor);
    a.c = imul(a.c, factor);
    for (int k = 0; k < NVAR; ++k) a.g[k] = imul(a.g[k], factor);
    return a;
}
/* The value after rounding, wrong by at most `part` of it and by `absolute`. The value may be as
   large as float32 holds. */
static jet rounded_by(boxes *K, jet x, V part, double absolute) {
    iv apart = between(-absolute, absolute);
    K->bad |= ~within(x.v, -LARGEST_FLOAT * 0.99, LARGEST_FLOAT * 0.99);
    x = by_factor(x, (iv){part - 1, 1 + part});
    x.v = iadd(x.v, apart);
    x.c = iadd(x.c, apart);
    return x;
}
static jet rounded(boxes *K, jet x, double part, double absolute) {
    return rounded_by(K, x, all(part), absolute);
}
/* The same where the error grows with the magnitude of the argument: part + more |argument| */
static jet rounded_more(boxes *K, jet x, double part, double absolute, double more, jet argument) {
    return rounded_by(K, x, largest(iabs(argument.v)) * more + part, absolute);
}
/* A constant and the float32 number that stands for it */
static jet inexact(boxes *K UNUSED, double lower, double upper) {
    jet y;
    y.v = y.c = between(lower, upper);
    for (int k = 0; k < NVAR; ++k) y.g[k] = number(0);
    return y;
}
/* The derivative that a passes on to the larger, or the smaller one, of two operands. Where the box
   does not decide which one that is, it is a part of it between none and all. */
static jet passed_on(jet a, M all_of_it, M nothing) {
    V zero = all(0), one = all(1);
    return by_factor(a, (iv){pick(all_of_it, -one, zero), pick(nothing & ~all_of_it, zero, one)});
}
INLINE jet to_larger2(boxes *K UNUSED, jet d, jet a, jet b) {
    return passed_on(d, -a.v.n >= b.v.h, -b.v.n >= a.v.h);
}
INLINE jet to_smaller2(boxes *K UNUSED, jet d, jet a, jet b) {
    return passed_on(d, a.v.h <= -b.v.n, b.v.h <= -a.v.n);
}
INLINE jet with_sign2(boxes *K UNUSED, jet d, jet a) {
    return by_factor(d, (iv){pick(a.v.n <= 0, all(-1), all(1)), pick(a.v.h < 0, all(-1), all(1))});
}
/* Add a bound to an error. */
static jet wider(jet e, V more) {
    e.v.h += more;
    e.c.h += more;
    return e;
}
INLINE V size_of(jet a) { return largest(iabs(a.v)); }

#define LARGER_PART(d, a, b) to_larger2(K, JET(d), JET(a), JET(b))
#define SMALLER_PART(d, a, b) to_smaller2(K, JET(d), JET(a), JET(b))
#define SIGNED(d, a) with_sign2(K, JET(d), JET(a))

/* The most conditions that a box may leave open */
#define MOST_OPEN 4

/* The error of a program with conditions. `error` bounds it while the conditions have the outcome
   that is assumed; `value` is the exact value for that outcome. It is needed for each outcome that
   rounding may give, also where the exact conditions have one only. If rounding changes an outcome,
   the value changes by at most the largest difference of two of them. */
static jet over_outcomes(
    boxes *K, const jet *x, jet (*error)(boxes *, const jet *), jet (*value)(boxes *, const jet *)) {
    jet e = error(K, x), at[1 << MOST_OPEN];
    unsigned long long known = 0, places[1 << MOST_OPEN];
    int count = 0;
    while (K->open != known) {
        known = K->open;
        if (__builtin_popcountll(known) > MOST_OPEN) {
            K->bad = ~(M){0};
            K->open = K->assumed = 0;
            return e;
        }
        unsigned long long some = 0;
        count = 0;
        do {
            K->assumed = places[count++] = some;
            jet f = error(K, x);
            e.v = ihull(e.v, f.v);
            e.c = ihull(e.c, f.c);
            for (int k = 0; k < NVAR; ++k) e.g[k] = ihull(e.g[k], f.g[k]);
            some = (some - known) & known;
        } while (some);
    }
    V apart = all(0);
    for (int i = 0; i < count; ++i) {
        K->assumed = places[i];
        at[i] = value(K, x);
        for (int j = 0; j < i; ++j) {
            jet difference = sub_jj(K, at[i], at[j]);
            apart = vmax(apart, size_of(difference));
        }
    }
    if (K->open != known) K->bad = ~(M){0};
    K->open = K->assumed = 0;
    return wider(e, apart);
}
