/* Coverage, weights, iterated colours and coordinates: docs/numbers.md, sections 3, 4 and 6.
 *
 * x and y are sixteenths of a pixel, n three edge functions, inverse_w the vertices' 1/w. */
#ifndef NV2A_RASTERIZATION_H
#define NV2A_RASTERIZATION_H

#include "nv2a_numbers.h"

/* Twice the signed area, in squares of a sixteenth of a pixel. */
static inline int64_t nv2a_signed_area(const int x[3], const int y[3]) {
    int64_t x1 = (int64_t)(x[1] - x[0]), x2 = (int64_t)(x[2] - x[0]);
    int64_t y1 = (int64_t)(y[1] - y[0]), y2 = (int64_t)(y[2] - y[0]);
    return x1 * y2 - x2 * y1;
}

/* The edge function of vertex k, from 0, at the middle of a pixel: 0 on the opposite edge, the area at the vertex. */
static inline int64_t nv2a_edge_function(const int x[3], const int y[3], int k, int px, int py) {
    int a = k == 2 ? 0 : k + 1, b = k == 0 ? 2 : k - 1;
    int64_t dx = (int64_t)(16 * px + 8 - x[a]), dy = (int64_t)(16 * py + 8 - y[a]);
    int64_t along = (int64_t)(x[b] - x[a]) * dy - (int64_t)(y[b] - y[a]) * dx;
    return nv2a_signed_area(x, y) < (int64_t)0 ? (int64_t)0 - along : along;
}

/* Whether the pixel is drawn: on an edge, where it is a left or a top one. */
static inline int nv2a_coverage(const int x[3], const int y[3], int px, int py) {
    int64_t zero = (int64_t)0;
    int turned = nv2a_signed_area(x, y) < zero, drawn = nv2a_signed_area(x, y) != zero;
    for (int k = 0; k < 3; k++) {
        int a = (k + (turned != 0 ? 2 : 1)) % 3, b = (k + (turned != 0 ? 1 : 2)) % 3;
        int64_t n = nv2a_edge_function(x, y, k, px, py);
        int owned = y[b] < y[a] || (y[b] == y[a] && x[b] > x[a]);
        if (n < zero || (n == zero && owned == 0)) drawn = 0;
    }
    return drawn;
}

/* 1/s of a positive s of 24 significant bits. */
static inline uint64_t nv2a_reciprocal_24(uint64_t s) {
    uint64_t significand = nv2a_f64_significand(s);
    int up = 52 - nv2a_top_bit_64(significand);
    uint32_t m = (uint32_t)(significand << up >> 29), near = (m + 256u) >> 9;
    uint32_t x = 67108864u / near;
    if (512u * (67108864u - x * near) >= 255u * near) x += 1u;
    int rest = (int)(0u - m * x);
    int half_up = (int)(((uint32_t)(rest < 0 ? -rest : rest) + 1023u) >> 11);
    uint64_t best = (uint64_t)x * (uint64_t)(uint32_t)(16777216 + (rest < 0 ? -half_up : half_up));
    return nv2a_f64_cut(nv2a_f64_round(0ull, -35 - nv2a_f64_bound(s), best), 24);
}

static inline uint64_t nv2a_weight_reciprocal(uint32_t s) {
    return nv2a_reciprocal_24(nv2a_f64_of_single(s));
}

/* 1/x of any sign: of 0 infinity, of infinity 0; the sign of what is not at least 0 changes. */
static inline uint64_t nv2a_reciprocal_of_sum(uint64_t x) {
    uint64_t size = nv2a_f64_magnitude(x), found;
    if (nv2a_f64_is_nan(x)) return 0x7ff8000000000000ull;
    if (size == 0ull) found = 0x7ff0000000000000ull;
    else if (!nv2a_f64_is_finite(x)) found = 0ull;
    else found = nv2a_reciprocal_24(size);
    return nv2a_f64_less(x, 0ull) ? nv2a_f64_subtract(0ull, found) : found;
}

/* What each vertex's edge function is multiplied with: the product of the other two w, with the sign of its own; one
 * where the three are equal. */
static inline void nv2a_weight_factors(const uint64_t inverse_w[3], uint64_t result[3]) {
    int equal = inverse_w[0] == inverse_w[1] && inverse_w[1] == inverse_w[2];
    uint64_t w[3];
    for (int k = 0; k < 3; k++) {
        w[k] = 0x3ff0000000000000ull;
        if (!equal) {
            w[k] = nv2a_f64_to_single(nv2a_f64_divide(0x3ff0000000000000ull, nv2a_f64_magnitude(inverse_w[k])));
            if (w[k] > 0x47efffffe0000000ull) w[k] = 0x47efffffe0000000ull; /* the largest single */
        }
    }
    for (int k = 0; k < 3; k++) {
        uint64_t others = nv2a_f64_cut(nv2a_f64_product(w[k == 0 ? 1 : 0], w[k == 2 ? 1 : 2]), 24);
        if (others < 0x2d30000000000000ull) others = 0x2d30000000000000ull; /* 2^-300 */
        result[k] = equal ? 0x3ff0000000000000ull : others | (inverse_w[k] & 0x8000000000000000ull);
    }
}

/* The edge functions by their factors, of 24 bits. */
static inline void nv2a_weighed_edges(const uint64_t n[3], const uint64_t factors[3], uint64_t e[3]) {
    for (int k = 0; k < 3; k++) e[k] = nv2a_f64_cut(nv2a_f64_product(nv2a_f64_cut(n[k], 24), factors[k]), 24);
}

/* Their sum, of which each loses what is more than a bit below the 24 of the largest. */
static inline uint64_t nv2a_weight_sum(const uint64_t e[3]) {
    int bound = -255;
    for (int k = 0; k < 3; k++) {
        if (!nv2a_f64_is_zero(e[k])) bound = nv2a_most(bound, nv2a_f64_bound(e[k]));
    }
    int64_t total = (int64_t)0;
    for (int k = 0; k < 3; k++) total = total + nv2a_f64_in_units(e[k], bound - 25);
    return nv2a_f64_of_units(total, bound - 25, 24);
}

/* What two weights leave of one. */
static inline uint64_t nv2a_rest_of(uint64_t a, uint64_t b) {
    int64_t taken = nv2a_f64_in_units(a, -25) + nv2a_f64_in_units(b, -25);
    return nv2a_f64_of_units((int64_t)33554432 - taken, -25, 24);
}

/* How many of 1/2 and 1/4 a weight reaches. */
static inline int nv2a_weight_class(uint64_t q) {
    if ((q & 0x8000000000000000ull) != 0ull || q < 0x3fd0000000000000ull) return 0;
    return q < 0x3fe0000000000000ull ? 1 : 2;
}

/* The weights of vertices 0 and 2, of edge functions and 1/w as doubles. */
static inline void nv2a_weights(const uint64_t n[3], const uint64_t inverse_w[3], uint64_t result[2]) {
    uint64_t factors[3], e[3], q[3];
    nv2a_weight_factors(inverse_w, factors);
    nv2a_weighed_edges(n, factors, e);
    uint64_t total = nv2a_weight_sum(e);
    if (nv2a_f64_is_zero(total)) total = 0x3ff0000000000000ull;
    uint64_t by = nv2a_reciprocal_of_sum(total);
    for (int k = 0; k < 3; k++) q[k] = nv2a_f64_cut(nv2a_f64_product(e[k], by), 24);
    int c0 = nv2a_weight_class(q[0]), c1 = nv2a_weight_class(q[1]), c2 = nv2a_weight_class(q[2]);
    result[0] = q[0];
    result[1] = q[2];
    if (c0 >= c1 && c0 > c2) result[0] = nv2a_rest_of(q[1], q[2]);
    if (c2 >= c0 && (c2 > c1 || (c2 == c1 && c0 == c1))) result[1] = nv2a_rest_of(q[0], q[1]);
}

static inline void nv2a_iteration_weights(const int n[3], const uint32_t inverse_w[3], uint64_t result[2]) {
    uint64_t edges[3], inverse[3];
    for (int k = 0; k < 3; k++) {
        edges[k] = nv2a_f64_of_int(n[k]);
        inverse[k] = nv2a_f64_of_single(inverse_w[k]);
    }
    nv2a_weights(edges, inverse, result);
}

/* A colour's component of three vertices, by weights of 8 bits. */
static inline int nv2a_weighed_color(const uint64_t q[2], const int c[3]) {
    int w0 = nv2a_clamp(nv2a_int_of_f64(nv2a_f64_scaled(q[0], 8)), -65536, 65536);
    int w2 = nv2a_clamp(nv2a_int_of_f64(nv2a_f64_scaled(q[1], 8)), -65536, 65536);
    int found = (w0 * c[0] + (256 - w0 - w2) * c[1] + w2 * c[2] + 128) >> 8;
    int least = nv2a_least(nv2a_least(c[0], c[1]), c[2]), most = nv2a_most(nv2a_most(c[0], c[1]), c[2]);
    return nv2a_clamp(found, least, most);
}

static inline int nv2a_iterated_color(const int n[3], const uint32_t inverse_w[3], const int c[3]) {
    uint64_t q[2];
    nv2a_iteration_weights(n, inverse_w, q);
    return nv2a_weighed_color(q, c);
}

/* The place of the highest bit; that of 0 is below all others. */
static inline int nv2a_highest(uint64_t a) {
    return nv2a_f64_is_zero(a) ? -1048576 : nv2a_f64_bound(a) - 1;
}

/* The sum of three products, each cut to 2^-23 of the largest product of two factors' highest bits; 24 bits of it. */
static inline uint64_t nv2a_product_sum(const uint64_t a[3], const uint64_t b[3]) {
    int e = -100;
    for (int k = 0; k < 3; k++) {
        if (!nv2a_f64_is_finite(a[k]) || !nv2a_f64_is_finite(b[k])) return 0x7ff8000000000000ull;
        e = nv2a_most(e, nv2a_highest(a[k]) + nv2a_highest(b[k]));
    }
    int64_t total = (int64_t)0;
    for (int k = 0; k < 3; k++) total = total + nv2a_f64_in_units(nv2a_f64_product(a[k], b[k]), e - 23);
    return nv2a_f64_of_units(total, e - 23, 24);
}

/* a - b of vertices' coordinates, both cut a bit below the 24 of the larger; 24 bits of it. */
static inline uint64_t nv2a_coordinate_difference(uint64_t a, uint64_t b) {
    if (!nv2a_f64_is_finite(a) || !nv2a_f64_is_finite(b)) return nv2a_f64_subtract(a, b);
    int bound = -99;
    if (!nv2a_f64_is_zero(a)) bound = nv2a_most(bound, nv2a_f64_bound(a));
    if (!nv2a_f64_is_zero(b)) bound = nv2a_most(bound, nv2a_f64_bound(b));
    int64_t steps = nv2a_f64_in_units(a, bound - 25) - nv2a_f64_in_units(b, bound - 25);
    return nv2a_f64_of_units(steps, bound - 25, 24);
}

/* A texture coordinate of three vertices' doubles, by the weights of vertices 0 and 2. */
static inline uint64_t nv2a_weighed_coordinate(const uint64_t q[2], const uint64_t v[3]) {
    uint64_t a[3] = {v[1], q[0], q[1]};
    uint64_t b[3] = {0x3ff0000000000000ull, 0ull, 0ull};
    b[1] = nv2a_coordinate_difference(v[0], v[1]);
    b[2] = nv2a_coordinate_difference(v[2], v[1]);
    return nv2a_product_sum(a, b);
}

static inline uint64_t nv2a_iterated_coordinate(const int n[3], const uint32_t inverse_w[3], const uint32_t v[3]) {
    uint64_t q[2], values[3];
    nv2a_iteration_weights(n, inverse_w, q);
    for (int k = 0; k < 3; k++) values[k] = nv2a_f64_of_single(v[k]);
    return nv2a_weighed_coordinate(q, values);
}

/* s, t or r over q, for a texture's access. A q of 0 counts as 2^-64. */
static inline uint64_t nv2a_divided_coordinate(uint32_t c, uint32_t q) {
    uint64_t by = nv2a_f64_of_single(q);
    if (nv2a_f64_is_zero(by)) by = 0x3bf0000000000000ull;
    return nv2a_f64_cut(nv2a_f64_multiply(nv2a_f64_of_single(c), nv2a_reciprocal_of_sum(by)), 24);
}

#endif
