/* A function of two variables that is a polynomial on each of many patches, which overlap.

   Defined before this file: SLABS; BY_X and BY_Y, the numbers of powers in each variable; END_Y;
   slab_end[SLABS]; slab_first[SLABS + 1], the number of the first patch of each slab; and for each
   patch patch_place[][4], the middle and half the width in both variables, and the coefficients
   patch_powers[][BY_X * BY_Y] of the powers of (x - middle)/half, those of y together. The patches of
   a slab divide [0, END_Y] evenly. */

/* Return the patch around a point. If a wrong one is returned, the box is refused, not misjudged. */
static int patch_at(double x, double y) {
    int slab = 0;
    while (slab + 1 < SLABS && x > slab_end[slab]) ++slab;
    int count = slab_first[slab + 1] - slab_first[slab], k = (int)(y / END_Y * count);
    return slab_first[slab] + (k < 0 ? 0 : k >= count ? count - 1 : k);
}
/* (x - middle)/half */
static jet local(boxes *K, jet x, V middle, V half) {
    iv inverse = ireciprocal(point(half)), shift = point(middle);
    jet y = {imul(isub(x.v, shift), inverse), imul(isub(x.c, shift), inverse), {}};
    for (int k = 0; k < NVAR; ++k) y.g[k] = imul(x.g[k], inverse);
    return settle(K, y);
}
static jet patched(boxes *K, jet x, jet y) {
    int at[8];
    V place[4];
    for (int i = 0; i < 8; ++i) {
        at[i] = patch_at(x.c.h[i], y.c.h[i]);
        for (int k = 0; k < 4; ++k) place[k][i] = patch_place[at[i]][k];
    }
    jet s = local(K, x, place[0], place[1]), t = local(K, y, place[2], place[3]), sum;
    /* The polynomial is near the function on its own patch only. */
    K->bad |= ~(within(s.v, -1, 1) & within(t.v, -1, 1));
    for (int a = BY_X - 1; a >= 0; --a) {
        jet row;
        for (int b = BY_Y - 1; b >= 0; --b) {
            V power;
            for (int i = 0; i < 8; ++i) power[i] = patch_powers[at[i]][a * BY_Y + b];
            jet term = constant(point(power));
            row = b == BY_Y - 1 ? term : add2(K, times(K, row, t), term);
        }
        sum = a == BY_X - 1 ? row : add2(K, times(K, sum, s), row);
    }
    return sum;
}
