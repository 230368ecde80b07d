/* Depths, their slopes, and the words of depth buffers: docs/numbers.md, section 5. */
#ifndef NV2A_DEPTH_H
#define NV2A_DEPTH_H

#include "nv2a_rasterization.h"

/* a - b of depths to 24 bits; 0 below 2^-126. */
static inline uint64_t nv2a_depth_difference(uint64_t a, uint64_t b) {
    uint64_t found = nv2a_f64_cut(nv2a_f64_subtract(a, b), 24);
    return nv2a_f64_magnitude(found) < 0x3810000000000000ull ? 0ull : found;
}

/* A vertex's depth and two products, which are cut 29 bits below the largest's highest; 24 bits of the sum. */
static inline uint64_t nv2a_depth_sum(uint64_t middle, uint64_t first, uint64_t last) {
    uint64_t largest = nv2a_f64_larger(nv2a_f64_magnitude(first), nv2a_f64_magnitude(last));
    largest = nv2a_f64_larger(nv2a_f64_magnitude(middle), largest);
    if (nv2a_f64_is_zero(largest)) return 0ull;
    int unit = nv2a_f64_bound(largest) - 29;
    uint64_t sum = middle;
    for (int k = 0; k < 2; k++) sum = nv2a_f64_add(sum, nv2a_f64_multiple(k == 0 ? first : last, unit));
    return nv2a_f64_cut(sum, 24);
}

/* 1/sum in 29 bits, of positive numbers: 14 bits, and a Newton step whose remainder is rounded to 2^-30. */
static inline uint64_t nv2a_reciprocal_29(uint64_t sum) {
    uint64_t one = 0x3ff0000000000000ull, x = nv2a_f64_cut(sum, 29);
    uint64_t seed = (nv2a_f64_divide(one, x) + 0x4000000000ull) >> 39 << 39;
    uint64_t rest = nv2a_f64_subtract(one, nv2a_f64_multiply(x, seed));
    uint64_t nearest = nv2a_f64_multiple(rest, -30);
    uint64_t left = nv2a_f64_magnitude(nv2a_f64_subtract(rest, nearest));
    uint64_t step = nv2a_f64_less(rest, 0ull) ? 0xbe10000000000000ull : 0x3e10000000000000ull;
    if (nv2a_f64_less(0x3e00000000000000ull, left)) nearest = nv2a_f64_add(nearest, step);
    return nv2a_f64_cut(nv2a_f64_add(seed, nv2a_f64_multiply(seed, nearest)), 29);
}

/* The depth of a fragment from edge functions as doubles and three vertices' depths. */
static inline uint64_t nv2a_depth_of_edges(const uint64_t n[3], const uint64_t z[3]) {
    uint64_t e[3], products[2], total = 0ull;
    for (int k = 0; k < 3; k++) {
        e[k] = nv2a_f64_cut(n[k], 24);
        total = nv2a_f64_add(total, e[k]);
    }
    uint64_t by = nv2a_reciprocal_29(total);
    int e0 = (int)(uint32_t)(e[0] >> 52) & 2047, e1 = (int)(uint32_t)(e[1] >> 52) & 2047;
    int e2 = (int)(uint32_t)(e[2] >> 52) & 2047, base = e0 > e1 ? 0 : 1, k = 0;
    if (e2 > e0 && e2 > e1) base = 2;
    for (int i = 0; i < 3; i++) {
        if (i != base) {
            uint64_t q = nv2a_f64_cut(nv2a_f64_product(e[i], by), 24);
            products[k] = nv2a_f64_product(q, nv2a_depth_difference(z[i], z[base]));
            k += 1;
        }
    }
    return nv2a_depth_sum(z[base], products[0], products[1]);
}

static inline uint64_t nv2a_depth(const int n[3], const uint32_t z[3]) {
    uint64_t edges[3], depths[3];
    for (int k = 0; k < 3; k++) {
        edges[k] = nv2a_f64_of_int(n[k]);
        depths[k] = nv2a_f64_of_single(z[k]);
    }
    return nv2a_depth_of_edges(edges, depths);
}

/* The depth of W buffering from weights and three vertices' w as doubles. */
static inline uint64_t nv2a_weighed_w(const uint64_t q[2], const uint64_t w[3]) {
    uint64_t products[2];
    for (int k = 0; k < 2; k++) products[k] = nv2a_f64_product(q[k], nv2a_depth_difference(w[2 * k], w[1]));
    return nv2a_depth_sum(w[1], products[0], products[1]);
}

static inline uint64_t nv2a_depth_of_w(const int n[3], const uint32_t w[3]) {
    uint64_t edges[3], inverse[3], depths[3], q[2];
    for (int k = 0; k < 3; k++) {
        edges[k] = nv2a_f64_of_int(n[k]);
        depths[k] = nv2a_f64_of_single(w[k]);
        inverse[k] = nv2a_f64_divide(0x3ff0000000000000ull, depths[k]);
    }
    nv2a_weights(edges, inverse, q);
    return nv2a_weighed_w(q, depths);
}

/* What a polygon offset's factor adds: the larger of the slopes along x and y, times it. */
static inline uint64_t nv2a_polygon_offset_slope(
    const int x[3], const int y[3], const uint32_t v[3], uint32_t factor) {
    uint64_t d[2], steepest = 0ull;
    int64_t area = nv2a_signed_area(x, y);
    if (area == (int64_t)0) return 0ull;
    for (int k = 0; k < 2; k++) {
        d[k] = nv2a_f64_subtract(nv2a_f64_of_single(v[k + 1]), nv2a_f64_of_single(v[0]));
    }
    for (int axis = 0; axis < 2; axis++) {
        uint64_t rise = 0x8000000000000000ull;
        for (int k = 0; k < 2; k++) {
            int reach = axis == 0 ? y[2 - k] - y[0] : x[2 - k] - x[0];
            rise = nv2a_f64_add(rise, nv2a_f64_multiply(d[k], nv2a_f64_of_int(k == 0 ? reach : -reach)));
        }
        rise = nv2a_f64_multiply(rise, 0x4030000000000000ull);
        uint64_t slope = nv2a_f64_magnitude(nv2a_f64_divide(rise, nv2a_f64_of_int64(area)));
        steepest = nv2a_f64_larger(steepest, slope);
    }
    return nv2a_f64_multiply(nv2a_f64_of_single(factor), steepest);
}

/* ---------------------------------------------------------------------------------------------- W's slope */

/* The weights that the slope reads of one pixel: of vertices 0 and 2; their sum before it divides, uncut; whether
 * there are any. */
static inline void nv2a_slope_weights(
    const int x[3], const int y[3], const uint64_t factors[3], int px, int py, uint64_t result[4]) {
    uint64_t n[3], e[3];
    for (int k = 0; k < 3; k++) n[k] = nv2a_f64_of_int64(nv2a_edge_function(x, y, k, px, py));
    nv2a_weighed_edges(n, factors, e);
    uint64_t total = nv2a_weight_sum(e), by = 0x3ff0000000000000ull, sum = 0x8000000000000000ull;
    for (int k = 0; k < 3; k++) sum = nv2a_f64_add(sum, nv2a_f64_multiply(n[k], factors[k]));
    result[2] = sum;
    result[3] = nv2a_f64_less(0ull, total) ? 1ull : 0ull;
    if (result[3] != 0ull) by = nv2a_reciprocal_24(total);
    result[0] = nv2a_f64_cut(nv2a_f64_product(e[0], by), 24);
    result[1] = nv2a_f64_cut(nv2a_f64_product(e[2], by), 24);
}

/* Whether a pixel is drawn, also where a vertex's w is negative. */
static inline int nv2a_coverage_by_w(const int x[3], const int y[3], const uint32_t w[3], int px, int py) {
    int64_t zero = (int64_t)0;
    int turned = nv2a_signed_area(x, y) < zero, drawn = nv2a_signed_area(x, y) != zero;
    for (int k = 0; k < 3; k++) {
        int behind = w[k] > 0x80000000u, swaps = (turned != 0) != (behind != 0);
        int a = (k + (swaps != 0 ? 2 : 1)) % 3, b = (k + (swaps != 0 ? 1 : 2)) % 3;
        int64_t n = nv2a_edge_function(x, y, k, px, py);
        if (behind != 0) n = zero - n;
        int owned = y[b] < y[a] || (y[b] == y[a] && x[b] > x[a]);
        if (n < zero || (n == zero && owned == 0)) drawn = 0;
    }
    return drawn;
}

/* The slope of W buffering's polygon offset, of the first 2x2 block that the triangle draws in a box: left, top,
 * right, bottom, from 0. */
static inline uint64_t nv2a_slope_of_w(const int x[3], const int y[3], const uint32_t w[3], const int box[4]) {
    uint64_t depths[3], inverse[3], factors[3], found = 0ull, nearest = 0ull;
    int behind = 0, first = 0, any = 0, tile_x = 0, tile_y = 0, closest = 0;
    for (int k = 0; k < 3; k++) {
        depths[k] = nv2a_f64_of_single(w[k]);
        inverse[k] = nv2a_f64_divide(0x3ff0000000000000ull, depths[k]);
        if ((w[k] & 0x80000000u) != 0u && (w[k] & 0x7fffffffu) != 0u) behind = 1;
        if (y[k] < y[first]) first = k;
    }
    nv2a_weight_factors(inverse, factors);
    int at = nv2a_clamp(x[first] >> 4, box[0], box[2] - 1) >> 2;
    int top = behind != 0 ? box[1] : nv2a_most(box[1], nv2a_clamp(y[first] >> 4, box[1], box[3] - 1) >> 2 << 2);
    for (int py = top; py < box[3]; py++) {
        if (any != 0 && py >> 2 != tile_y) break;
        for (int px = box[0]; px < box[2]; px++) {
            int away = (px >> 2) - at;
            if (away < 0) away = -away;
            if ((any == 0 || away < closest || (away == closest && px >> 2 < tile_x))
                && nv2a_coverage_by_w(x, y, w, px, py) != 0) {
                any = 1;
                tile_x = px >> 2;
                tile_y = py >> 2;
                closest = away;
            }
        }
    }
    if (any == 0) return 0ull;
    int upper_only = 0;
    for (int block = 0; block < 4; block++) {
        int left = 4 * tile_x + 2 * (block & 1), row = 4 * tile_y + (block & 2), drawn = 0, good = 1;
        uint64_t a[4], b[4], near = 0ull;
        if (block >= 2 && upper_only != 0) break;
        for (int k = 0; k < 4; k++) {
            int px = left + (k & 1), py = row + (k >> 1);
            if (px >= box[0] && px < box[2] && py >= top && py < box[3]
                && nv2a_coverage_by_w(x, y, w, px, py) != 0) drawn = 1;
        }
        if (drawn != 0) {
            if (row == 0 && y[first] < 0) upper_only = 1;
            for (int k = 0; k < 4; k++) {
                uint64_t of[4];
                nv2a_slope_weights(x, y, factors, left + (k & 1), row + (k >> 1), of);
                a[k] = of[0];
                b[k] = of[1];
                if (k == 0) near = of[2];
                if (of[3] == 0ull) good = 0;
            }
            if (good != 0 && !nv2a_f64_less(near, nearest)) {
                nearest = near;
                found = 0ull;
                for (int axis = 0; axis < 2; axis++) {
                    uint64_t along = 0x8000000000000000ull;
                    for (int k = 0; k < 2; k++) { /* of vertex 0, then of vertex 2 */
                        uint64_t step = nv2a_depth_difference(depths[2 * k], depths[1]);
                        uint64_t from = a[axis == 0 ? 2 : 0], to = a[axis == 0 ? 3 : 2];
                        if (k == 1) {
                            from = b[axis == 0 ? 0 : 1];
                            to = b[axis == 0 ? 1 : 3];
                        }
                        along = nv2a_f64_add(along, nv2a_f64_multiply(nv2a_f64_subtract(to, from), step));
                    }
                    found = nv2a_f64_larger(found, nv2a_f64_magnitude(along));
                }
                found = nv2a_f64_cut(found, 24);
            }
        }
    }
    return found;
}

/* ------------------------------------------------------------------------------------------------- words */

/* A depth within 0 and the largest word of a fixed format, as that word. */
static inline int nv2a_fixed_word(uint64_t depth, int largest) {
    if (!nv2a_f64_less(0ull, depth)) return 0;
    return nv2a_least(nv2a_int_of_f64(depth), largest);
}

static inline int nv2a_depth_word_fixed_16(uint64_t depth) {
    return nv2a_fixed_word(depth, 65535);
}

static inline int nv2a_depth_word_fixed_24(uint64_t depth) {
    return nv2a_fixed_word(depth, 16777215);
}

/* A depth as a float without a sign: so many bits of fraction, an exponent's bias, the largest word. */
static inline int nv2a_float_word(uint64_t depth, int fraction_bits, int bias, int largest) {
    int e = nv2a_f64_bound(depth) - 1 + bias;
    if (!nv2a_f64_less(0ull, depth) || e < 1) return 0;
    if (e > largest >> fraction_bits) return largest;
    int fraction = (int)(uint32_t)(nv2a_f64_significand(depth) >> (52 - fraction_bits)) - (1 << fraction_bits);
    return nv2a_least((e << fraction_bits) + fraction, largest);
}

static inline int nv2a_depth_word_float_16(uint64_t depth) {
    return nv2a_float_word(depth, 12, 7, 65535);
}

static inline int nv2a_depth_word_float_24(uint64_t depth) {
    return nv2a_float_word(depth, 16, 127, 0xfeffff);
}

#endif
