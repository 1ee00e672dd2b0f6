/* Branch and bound: prove |error| <= a level on every box of a stack, or raise the level.

   The printed program is `error_at(boxes *K, const jet *x)`. */
#include <fenv.h>

/* What a call begins with and leaves behind. `stack` holds `depth` boxes of 2 NVAR numbers, lower
   ends first. The level is `ratio` times the largest `lower` that was found, at least `level`. The
   first `leaf_capacity` boxes that are proven are copied to `leaves`. */
typedef struct {
    double *stack;
    long depth, capacity, budget;
    double ratio, level, lower, at[NVAR], whole[NVAR];
    double reached, volume;
    long boxes, status;
    double *leaves;
    long leaf_count, leaf_capacity;
} search;

enum { FINISHED, BUDGET, STACK_FULL, STUCK, ROUNDING, REFUTED };

static int rounds_upward(void) {
    volatile double one = 1, tiny = 0x1p-60, three = 3;
    V a = all(one), b = all(tiny), c = all(three);
    V sum = a + b, difference = b - a, product = (a + b) * (a + b), quotient = a / c, s = vsqrt(c);
    V below = -a / c;
    volatile double least = DBL_MIN;
    V half = all(least) * 0.5;
    for (int i = 0; i < 8; ++i) {
        if (!(sum[i] > 1) || !(difference[i] > -1) || !(product[i] > 1 + 0x1p-52)) return 0;
        if (!(quotient[i] == 0x1.5555555555556p-2) || !(below[i] == -0x1.5555555555555p-2)) return 0;
        if (!(s[i] == 0x1.bb67ae8584cabp+0) || !(half[i] > 0)) return 0;
    }
    /* A fused multiply-add would find the rounding error of the product, which is not zero. x is
       read twice, so that the compiler does not see that both products are one. */
    volatile double x = 1 + 0x1p-30;
    V y = all(x), z = all(x), p = z * z, rest = y * y - p;
    for (int i = 0; i < 8; ++i)
        if (rest[i] != 0) return 0;
    return 1;
}

static void load(const double *stack, long first, int count, jet *x, boxes *K) {
    for (int k = 0; k < NVAR; ++k) {
        V low, high;
        for (int i = 0; i < 8; ++i) {
            const double *box = stack + 2 * NVAR * (first + (i < count ? i : 0));
            low[i] = box[k];
            high[i] = box[NVAR + k];
        }
        V centre = pick(low < high, low * 0.5 + high * 0.5, low);
        x[k].v = (iv){-low, high};
        x[k].c = point(centre);
        for (int j = 0; j < NVAR; ++j) x[k].g[j] = number(j == k);
        K->r[k] = vmax(centre - low, high - centre);
    }
    K->bad = K->flat = (M){0};
    K->open = K->assumed = 0;
}

_Static_assert(__COUNTER__ <= 64, "at most 64 conditions");

/* Evaluate the error for every combination of the conditions that are not decided. */
static jet error_for_all(boxes *K, const jet *x) {
    jet e = error_at(K, x);
    if (K->open == 0) return e;
    unsigned long long known = 0;
    while (K->open != known) {
        known = K->open;
        if (__builtin_popcountll(known) > 6) {
            K->bad = ~(M){0};
            return e;
        }
        /* The subsets of the bits in `known`, beginning with the empty one, which is done. */
        for (unsigned long long some = (0 - known) & known; some; some = (some - known) & known) {
            K->assumed = some;
            jet f = error_at(K, x);
            e.v = ihull(e.v, f.v);
            e.c = ihull(e.c, f.c);
            for (int k = 0; k < NVAR; ++k) e.g[k] = ihull(e.g[k], f.g[k]);
        }
    }
    return e;
}

/* Return the side to divide: the one over which slopes change the error most. */
static int widest(const search *s, const boxes *K, const jet *e, const double *box, int i) {
    int best = -1, plain = K->bad[i] || K->flat[i];
    double most = 0;
    for (int k = 0; k < NVAR; ++k) {
        double width = box[NVAR + k] - box[k];
        double middle = 0.5 * box[k] + 0.5 * box[NVAR + k];
        double effect = plain ? width / s->whole[k] : largest(e->g[k])[i] * width;
        if (middle > box[k] && middle < box[NVAR + k] && effect > most) best = k, most = effect;
    }
    /* Slopes that are zero show no side: take the longest. */
    for (int k = 0; best < 0 && k < NVAR; ++k) {
        double width = (box[NVAR + k] - box[k]) / s->whole[k];
        double middle = 0.5 * box[k] + 0.5 * box[NVAR + k];
        if (middle > box[k] && middle < box[NVAR + k] && width > most) best = k, most = width;
    }
    return best;
}

static void run(search *s) {
    double batch[8 * 2 * NVAR];
    long end = s->boxes + s->budget;
    if (!rounds_upward()) {
        s->status = ROUNDING;
        return;
    }
    s->status = FINISHED;
    while (s->depth > 0) {
        if (s->boxes >= end) {
            s->status = BUDGET;
            return;
        }
        if (s->depth + 8 > s->capacity) {
            s->status = STACK_FULL;
            return;
        }
        int count = s->depth < 8 ? (int)s->depth : 8;
        jet x[NVAR];
        boxes K;
        load(s->stack, s->depth - count, count, x, &K);
        jet e = error_for_all(&K, x);
        for (int i = 0; i < count; ++i) {
            double centre = __builtin_fmax(-e.c.h[i], -e.c.n[i]);
            /* A lane that overflows has no centre: the test of finite numbers is in `bad`. */
            if (!K.bad[i] && centre > s->lower) {
                s->lower = centre;
                for (int k = 0; k < NVAR; ++k) s->at[k] = x[k].c.h[i];
            }
        }
        s->level = __builtin_fmax(s->level, s->lower * s->ratio);
        s->boxes += count;
        if (s->lower > s->level) {
            s->status = REFUTED;
            return;
        }
        s->depth -= count;
        __builtin_memcpy(batch, s->stack + 2 * NVAR * s->depth, sizeof(double) * 2 * NVAR * count);
        for (int i = 0; i < count; ++i) {
            const double *box = batch + 2 * NVAR * i;
            double above = e.v.h[i], below = e.v.n[i];
            if (!K.bad[i] && above <= s->level && below <= s->level) {
                s->reached = __builtin_fmax(s->reached, __builtin_fmax(above, below));
                double volume = 1;
                for (int k = 0; k < NVAR; ++k) volume *= (box[NVAR + k] - box[k]) / s->whole[k];
                s->volume += volume;
                if (s->leaf_count < s->leaf_capacity)
                    __builtin_memcpy(
                        s->leaves + 2 * NVAR * s->leaf_count++, box, sizeof(double) * 2 * NVAR);
                continue;
            }
            int side = widest(s, &K, &e, box, i);
            /* A box that cannot be divided is put back, for a message that names it. */
            double *first = s->stack + 2 * NVAR * s->depth, *second = first + 2 * NVAR;
            __builtin_memcpy(first, box, sizeof(double) * 2 * NVAR);
            s->depth += 1;
            if (side < 0) {
                for (int rest = i + 1; rest < count; ++rest, ++s->depth)
                    __builtin_memcpy(
                        s->stack + 2 * NVAR * s->depth, batch + 2 * NVAR * rest,
                        sizeof(double) * 2 * NVAR);
                s->status = STUCK;
                return;
            }
            __builtin_memcpy(second, box, sizeof(double) * 2 * NVAR);
            first[NVAR + side] = second[side] = 0.5 * box[side] + 0.5 * box[NVAR + side];
            s->depth += 1;
        }
    }
}

/* Called through a pointer that the compiler cannot see through, so that nothing moves across the
   change of the rounding mode. The default environment keeps numbers below DBL_MIN, which other
   libraries may have set to be flushed to zero. */
static void (*volatile hidden)(search *) = run;

static void round_upward(fenv_t *before) {
    fegetenv(before);
    fesetenv(FE_DFL_ENV);
    fesetround(FE_UPWARD);
}

void shadefit_search(search *s) {
    fenv_t before;
    round_upward(&before);
    hidden(s);
    fesetenv(&before);
}

/* Bounds of the error on single boxes, for tests: lower, upper, lower and upper of the centre. */
static void enclose_one(const double *box, double *bounds) {
    jet x[NVAR];
    boxes K;
    load(box, 0, 1, x, &K);
    jet e = error_for_all(&K, x);
    bounds[0] = K.bad[0] ? -INFINITY : -e.v.n[0];
    bounds[1] = K.bad[0] ? INFINITY : e.v.h[0];
    bounds[2] = -e.c.n[0];
    bounds[3] = e.c.h[0];
}
static void (*volatile hidden_one)(const double *, double *) = enclose_one;

void shadefit_enclose(const double *box, double *bounds) {
    fenv_t before;
    round_upward(&before);
    hidden_one(box, bounds);
    fesetenv(&before);
}
