/* Fog: a line for each vertex, a table for each pixel: docs/numbers.md, section 9. */
#ifndef NV2A_FOG_H
#define NV2A_FOG_H

#include "nv2a_combiners.h"
#include "nv2a_lighting_unit.h"

/* Source: NV097_SET_FOG_MODE. */
enum { NV2A_FOG_EXP = 0x800, NV2A_FOG_EXP2 = 0x801, NV2A_FOG_LINEAR = 0x2601 };

/* 255 2^(-j/4) and 255 2^(-j j / 128), to nearest. */
static const int nv2a_fog_exp_nodes[33] = {
    255, 214, 180, 152, 128, 107, 90, 76, 64, 54, 45, 38, 32, 27, 23, 19, 16, 13, 11, 9, 8, 7, 6, 5, 4, 3, 3, 2, 2,
    2, 1, 1, 1
};
static const int nv2a_fog_exp2_nodes[33] = {
    255, 254, 250, 243, 234, 223, 210, 196, 180, 164, 148, 132, 117, 102, 88, 75, 64, 53, 44, 36, 29, 23, 19, 15, 11,
    9, 7, 5, 4, 3, 2, 1, 1
};

/* Rules fog-factor-...: the factor of n = floor(4096 v), 0 to 8192, of an iterated value v. */
static inline int nv2a_fog_factor_linear(int n) {
    return nv2a_least(nv2a_clamp(n - 4095, 0, 4096) * 255 >> 12, 255);
}

static inline int nv2a_fog_factor_exp(int n) {
    int x = nv2a_most(6144 - n, 0), j = nv2a_least(x >> 6, 31), f = x & 63;
    return x >= 2048 ? 0 : (nv2a_fog_exp_nodes[j] * (64 - f) + nv2a_fog_exp_nodes[j + 1] * f + 32) >> 6;
}

static inline int nv2a_fog_factor_exp_abs(int n) {
    return nv2a_fog_factor_exp(n > 6144 ? 12288 - n : n);
}

static inline int nv2a_fog_factor_exp2(int n) {
    int x = n > 6144 ? n - 6144 : 6144 - n, j = nv2a_least(x >> 6, 31), f = x & 63;
    return x >= 2048 ? 0 : (nv2a_fog_exp2_nodes[j] * (64 - f) + nv2a_fog_exp2_nodes[j + 1] * f + 32) >> 6;
}

/* n of an iterated value. */
static inline int nv2a_fog_steps(uint64_t v) {
    return nv2a_clamp(nv2a_floor_of_f64(nv2a_f64_multiply(v, 0x40b0000000000000ull)), 0, 8192);
}

/* Rule fog-line: the value of a vertex. */
static inline uint64_t nv2a_fog_line(int mode, uint32_t bias, uint32_t multiplier, uint32_t c) {
    uint32_t entered = nv2a_enter_lighting(c);
    uint64_t value;
    if (mode == NV2A_FOG_LINEAR) {
        value = 0x7ff0000000000000ull;
        if (nv2a_is_finite(entered)) {
            value = nv2a_f64_of_single(nv2a_unit_product(entered, nv2a_flushed(multiplier), 24));
        }
        value = nv2a_f64_add(value, nv2a_f64_of_single(nv2a_flushed(bias)));
        value = nv2a_f64_multiply(value, 0x4140000000000000ull); /* 2^21 */
        value = nv2a_f64_negated(nv2a_f64_floor(nv2a_f64_negated(value)));
        value = nv2a_f64_multiply(nv2a_f64_add(value, 0ull), 0x3ea0000000000000ull);
    } else {
        uint32_t product = nv2a_lighting_product(entered, nv2a_enter_lighting(multiplier));
        value = nv2a_f64_of_single(nv2a_lighting_sum(product, nv2a_enter_lighting(bias), 0u));
    }
    uint64_t largest = 0x47e0000000000000ull; /* 2^127 */
    if (nv2a_f64_is_nan(value) || nv2a_f64_less(largest, value)) return largest;
    return nv2a_f64_less(value, nv2a_f64_negated(largest)) ? nv2a_f64_negated(largest) : value;
}

/* Rule fog-blend: a colour's component, by the factor. */
static inline int nv2a_fog_blend(int f, int color, int fog) {
    return nv2a_rn(f * color + (255 - f) * fog);
}

#endif
