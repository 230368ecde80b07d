/* The lighting unit's numbers, singles of 14 significant bits, and what a vertex becomes: docs/numbers.md, N2.5 to
 * N2.7, N2.12 to N2.14, N2.25, N11.12. */
#ifndef NV2A_LIGHTING_UNIT_H
#define NV2A_LIGHTING_UNIT_H

#include "nv2a_vertex_programs.h"

/* A single as the unit reads it, rounded to 14 bits. */
static inline uint32_t nv2a_enter_lighting(uint32_t x) {
    if ((x >> 10 & 255u) != 255u) x += 512u;
    x &= 0xfffffc00u;
    return nv2a_is_nan(x) ? 0x7fc00000u : x;
}

/* a b cut to so many bits; an infinite product is positive, 0 times infinity is 0. */
static inline uint32_t nv2a_unit_product(uint32_t a, uint32_t b, int bits) {
    if (nv2a_is_nan(a) || nv2a_is_nan(b)) return 0x7fc00000u;
    if (nv2a_is_zero(a) || nv2a_is_zero(b)) return 0u;
    if (nv2a_is_infinite(a) || nv2a_is_infinite(b)) return 0x7f800000u;
    return nv2a_finite_product(a, b, bits);
}

static inline uint32_t nv2a_lighting_product(uint32_t a, uint32_t b) {
    return nv2a_unit_product(a, b, 14);
}

/* The sum of four terms; an infinite sum is positive. */
static inline uint32_t nv2a_lighting_total(const uint32_t x[4], int guard) {
    for (int k = 0; k < 4; k++) {
        if (!nv2a_is_finite(x[k])) return nv2a_program_sum(x) & 0x7fffffffu;
    }
    return nv2a_finite_sum(x, 14, guard);
}

static inline uint32_t nv2a_lighting_sum(uint32_t a, uint32_t b, uint32_t c) {
    uint32_t terms[4] = {a, b, c, 0u};
    return nv2a_lighting_total(terms, 5);
}

/* The product, then the sum: where a number is infinite or NaN. */
static inline uint32_t nv2a_product_and_sum(uint32_t a, uint32_t b, uint32_t c) {
    uint32_t terms[4] = {nv2a_lighting_product(a, b), c, 0u, 0u};
    return nv2a_lighting_total(terms, 0);
}

/* The 14 bits of a number that is not 0. */
static inline int nv2a_lighting_bits(uint32_t x) {
    return (int)(((x & 0x7fffffu) | 0x800000u) >> 10);
}

static inline uint32_t nv2a_signed_packed(int sum, int e) {
    uint32_t size = (uint32_t)(sum < 0 ? -sum : sum);
    return nv2a_packed(sum < 0 ? 0x80000000u : 0u, (uint64_t)size, e, 14);
}

static inline uint32_t nv2a_lighting_multiply_add(uint32_t a, uint32_t b, uint32_t c) {
    if (!nv2a_is_finite(a) || !nv2a_is_finite(b) || !nv2a_is_finite(c)) return nv2a_product_and_sum(a, b, c);
    if (nv2a_is_zero(a) || nv2a_is_zero(b)) return nv2a_is_zero(c) ? 0u : c & 0xfffffc00u;
    int ma = nv2a_lighting_bits(a), mb = nv2a_lighting_bits(b), mc = nv2a_is_zero(c) ? 0 : nv2a_lighting_bits(c);
    int place = (int)(a >> 23 & 255u) + (int)(b >> 23 & 255u) - 252, lower = 0; /* |a| < 2^i, |b| < 2^j: i + j */
    if (mc != 0) lower = (int)(c >> 23 & 255u) - 125 - place;
    int product, term;
    if (lower > 0) {
        product = lower < 14 ? (ma >> lower) * mb : 0;
        term = mc << 13;
    } else {
        product = ma * mb;
        term = lower > -14 ? (mc >> -lower) << 13 : 0;
    }
    if (((a ^ b) & 0x80000000u) != 0u) product = -product;
    if ((c & 0x80000000u) != 0u) term = -term;
    return nv2a_signed_packed(product + term, place - 28 + nv2a_most(lower, 0));
}

static inline uint32_t nv2a_lighting_add_product(uint32_t a, uint32_t b, uint32_t c) {
    if (!nv2a_is_finite(a) || !nv2a_is_finite(b) || !nv2a_is_finite(c)) return nv2a_product_and_sum(a, b, c);
    if (nv2a_is_zero(a) || nv2a_is_zero(b)) return nv2a_is_zero(c) ? 0u : c & 0xfffffc00u;
    int product = nv2a_lighting_bits(a) * nv2a_lighting_bits(b);
    int e = (int)(a >> 23 & 255u) + (int)(b >> 23 & 255u) - 280; /* of the product's last bit */
    int top = e + nv2a_top_bit((uint32_t)product) + 1, term = 0;
    if (!nv2a_is_zero(c)) {
        int place = (int)(c >> 23 & 255u) - 126;
        top = nv2a_most(top, place);
        term = nv2a_lighting_bits(c) << 1 >> nv2a_least(top - place, 31);
    }
    product = product >> nv2a_least(top - 15 - e, 31);
    if (((a ^ b) & 0x80000000u) != 0u) product = -product;
    if ((c & 0x80000000u) != 0u) term = -term;
    return nv2a_signed_packed(product + term, top - 15);
}

static inline uint32_t nv2a_lighting_reciprocal(uint32_t x) {
    uint32_t m = (uint32_t)nv2a_lighting_bits(x), seed = 16384u / (129u + 2u * (m >> 7 & 63u));
    uint64_t better = (uint64_t)((1u << 21) - seed * m) * (uint64_t)seed >> 14;
    int e = (int)(x >> 23 & 255u) - 127;
    return nv2a_with_limits(nv2a_packed(x & 0x80000000u, better, -13 - e, 24), x);
}

static const int nv2a_lighting_root_seeds[128] = {
    127, 126, 125, 124, 123, 122, 121, 121, 120, 119, 118, 117, 117, 116, 115, 114, 114, 113, 112, 112, 111, 110,
    110, 109, 108, 108, 107, 107, 106, 105, 105, 104, 104, 103, 103, 102, 102, 101, 101, 100, 100, 99, 99, 98, 98,
    97, 97, 96, 96, 96, 95, 95, 94, 94, 94, 93, 93, 92, 92, 92, 91, 91, 91, 90, 90, 89, 88, 88, 87, 86, 86, 85, 85,
    84, 83, 83, 82, 82, 81, 81, 80, 80, 79, 79, 78, 78, 77, 77, 76, 76, 76, 75, 75, 74, 74, 74, 73, 73, 72, 72, 72,
    71, 71, 71, 70, 70, 70, 69, 69, 69, 68, 68, 68, 67, 67, 67, 67, 66, 66, 66, 65, 65, 65, 65, 64, 64, 64, 64
};

/* 1/sqrt(|x|), of points' sizes. */
static inline uint32_t nv2a_lighting_inverse_square_root(uint32_t x) {
    int e = (int)(x >> 23 & 255u) - 127, odd = e & 1;
    int seed = nv2a_lighting_root_seeds[(int)(x >> 17 & 63u) + 64 * odd];
    return nv2a_with_limits(nv2a_packed(0u, (uint64_t)(uint32_t)seed, -7 - (e >> 1), 24), x & 0x7fffffffu);
}

/* ---------------------------------------------------------------------------------------- window and colour */

/* x of the composite matrix, its w and the viewport's offset: a window coordinate. */
static inline uint32_t nv2a_window_coordinate(uint32_t x, uint32_t w, uint32_t offset) {
    uint64_t by = nv2a_f64_of_single(nv2a_reciprocal(w));
    uint64_t quotient = nv2a_f64_cut(nv2a_f64_multiply(nv2a_f64_of_single(x), by), 24);
    return nv2a_single_of_f64(nv2a_f64_add(quotient, nv2a_f64_of_single(offset)));
}

/* A window coordinate in sixteenths of a pixel; extent: the surface's width, or its height. */
static inline int nv2a_snapped_coordinate(uint32_t x, int extent) {
    int e = (int)(x >> 23 & 255u) - 127, m = (int)((x & 0x7fffffu) | 0x800000u), steps;
    if (nv2a_is_nan(x)) return -16777216;
    if (e >= 22) steps = 67108864;
    else if (e >= 19) steps = m << (e - 19);
    else steps = m >> nv2a_least(19 - e, 31);
    return nv2a_clamp((x & 0x80000000u) != 0u ? -steps : steps, -16777216, 16 * (extent + 1048576));
}

/* A colour from 0 to 1 as a byte. */
static inline int nv2a_color_to_byte(uint32_t v) {
    int down = 140 - (int)(v >> 23 & 255u), m = 255 * nv2a_lighting_bits(v);
    return down > 24 ? 0 : (m + (1 << (down - 1))) >> down;
}

#endif
