/* Texture shaders: what dot products read, moved coordinates, results and depths: docs/numbers.md, section 12. */
#ifndef NV2A_TEXTURE_SHADERS_H
#define NV2A_TEXTURE_SHADERS_H

#include "nv2a_rasterization.h"

enum { NV2A_CULL_GEQUAL = 0, NV2A_CULL_LESS = 1 }; /* Source: NV097_SET_SHADER_CLIP_PLANE_MODE */

static inline int nv2a_signed_byte(int v) {
    return v > 127 ? v - 256 : v;
}

static inline int nv2a_signed_word(int v) {
    return v > 32767 ? v - 65536 : v;
}

static inline uint64_t nv2a_int_quotient(int n, int divisor) {
    return nv2a_f64_divide(nv2a_f64_of_int(n), nv2a_f64_of_int(divisor));
}

/* Rules dot-mapping-...: (x, y, z) that a dot product reads of a texel. */
static inline void nv2a_dot_mapping_unsigned_identity(const int texel[4], uint64_t result[3]) {
    for (int k = 0; k < 3; k++) result[k] = nv2a_int_quotient(texel[k], 255);
}

static inline void nv2a_dot_mapping_expand_normal(const int texel[4], uint64_t result[3]) {
    for (int k = 0; k < 3; k++) result[k] = nv2a_int_quotient(texel[k] - 128, 127);
}

static inline void nv2a_dot_mapping_signed_odd(const int texel[4], uint64_t result[3]) {
    for (int k = 0; k < 3; k++) result[k] = nv2a_int_quotient(2 * nv2a_signed_byte(texel[k]) + 1, 255);
}

static inline void nv2a_dot_mapping_signed_identity(const int texel[4], uint64_t result[3]) {
    for (int k = 0; k < 3; k++) result[k] = nv2a_int_quotient(nv2a_signed_byte(texel[k]), 127);
}

static inline void nv2a_dot_mapping_unsigned_hilo(const int texel[4], uint64_t result[3]) {
    result[0] = nv2a_int_quotient(256 * texel[3] + texel[0], 65535);
    result[1] = nv2a_int_quotient(256 * texel[1] + texel[2], 65535);
    result[2] = 0x3ff0000000000000ull;
}

static inline void nv2a_dot_mapping_signed_hilo_hemisphere(const int texel[4], uint64_t result[3]) {
    int x = nv2a_signed_word(256 * texel[3] + texel[0]), y = nv2a_signed_word(256 * texel[1] + texel[2]);
    uint32_t squares = (uint32_t)(x * x) + (uint32_t)(y * y);
    uint32_t rest = squares < 0x40000000u ? 0x40000000u - squares : 0u, root = 0u;
    for (int bit = 15; bit >= 0; bit--) {
        uint32_t more = root | 1u << bit;
        if (more <= 32768u && more * more <= rest) root = more;
    }
    result[0] = nv2a_int_quotient(x, 32767);
    result[1] = nv2a_int_quotient(y, 32767);
    result[2] = nv2a_int_quotient((int)root, 32768);
}

/* A shader's real number as a byte. */
static inline int nv2a_result_byte(uint64_t v) {
    if (!nv2a_f64_less(0ull, v)) v = 0ull;
    if (nv2a_f64_less(0x3ff0000000000000ull, v)) v = 0x3ff0000000000000ull;
    int steps = nv2a_int_of_f64(nv2a_f64_multiply(v, 0x40b0000000000000ull));
    return nv2a_least((steps + 1) * 255 >> 12, 255);
}

static inline int nv2a_shader_result_byte(uint32_t v) {
    return nv2a_result_byte(nv2a_f64_of_single(v));
}

/* The sum of three terms, each cut to the 24 bits of the largest. */
static inline uint64_t nv2a_cut_sum(const uint64_t terms[3]) {
    int bound = -99;
    for (int k = 0; k < 3; k++) {
        if (!nv2a_f64_is_finite(terms[k])) return 0x7ff8000000000000ull;
        if (!nv2a_f64_is_zero(terms[k])) bound = nv2a_most(bound, nv2a_f64_bound(terms[k]));
    }
    int64_t total = (int64_t)0;
    for (int k = 0; k < 3; k++) total = total + nv2a_f64_in_units(terms[k], bound - 24);
    return nv2a_f64_of_units(total, bound - 24, 53);
}

/* Rule offset-texture: s and t moved by a texel of signed blue and green. */
static inline void nv2a_offset_texture(
    const uint32_t st[2], const int texel[4], const uint32_t matrix[4], uint64_t result[2]) {
    uint64_t ds = nv2a_int_quotient(nv2a_signed_byte(texel[2]), 128);
    uint64_t dt = nv2a_int_quotient(nv2a_signed_byte(texel[1]), 128);
    for (int k = 0; k < 2; k++) {
        uint64_t terms[3] = {0ull, 0ull, 0ull};
        terms[0] = nv2a_f64_of_single(st[k]);
        terms[1] = nv2a_f64_multiply(nv2a_f64_of_single(matrix[k]), ds);
        terms[2] = nv2a_f64_multiply(nv2a_f64_of_single(matrix[k + 2]), dt);
        result[k] = nv2a_cut_sum(terms);
    }
}

/* Rule offset-luminance: a texel's colours by another's red. */
static inline void nv2a_offset_luminance(
    const int texel[4], int magnitude, uint32_t scale, uint32_t bias, int result[4]) {
    uint64_t factor = nv2a_f64_multiply(nv2a_int_quotient(magnitude, 255), nv2a_f64_of_single(scale));
    factor = nv2a_f64_add(factor, nv2a_f64_of_single(bias));
    for (int k = 0; k < 3; k++) {
        uint64_t color = nv2a_f64_multiply(nv2a_f64_of_int(texel[k]), factor);
        result[k] = nv2a_result_byte(nv2a_f64_divide(color, 0x406fe00000000000ull));
    }
    result[3] = texel[3];
}

/* The dot product of three numbers with three singles. */
static inline uint64_t nv2a_shader_dot(const uint64_t a[3], const uint64_t b[3]) {
    uint64_t singles[3];
    for (int k = 0; k < 3; k++) singles[k] = nv2a_f64_to_single(b[k]);
    return nv2a_product_sum(a, singles);
}

/* 2 n (n e) - e (n n), of doubles. */
static inline void nv2a_reflected(const uint64_t n[3], const uint64_t e[3], uint64_t result[3]) {
    uint64_t twice = nv2a_f64_multiply(0x4000000000000000ull, nv2a_shader_dot(n, e));
    uint64_t square = nv2a_shader_dot(n, n);
    for (int k = 0; k < 3; k++) {
        result[k] = nv2a_f64_subtract(nv2a_f64_multiply(n[k], twice), nv2a_f64_multiply(e[k], square));
    }
}

static inline void nv2a_reflection(const uint32_t normal[3], const uint32_t eye[3], uint64_t result[3]) {
    uint64_t n[3], e[3];
    for (int k = 0; k < 3; k++) {
        n[k] = nv2a_f64_of_single(normal[k]);
        e[k] = nv2a_f64_of_single(eye[k]);
    }
    nv2a_reflected(n, e, result);
}

/* Rule depth-replace: a/b as a word of 24 bits; -1 where the fragment ends. */
static inline int nv2a_depth_replace(uint32_t a, uint32_t b) {
    uint64_t z = nv2a_f64_multiply(nv2a_f64_of_single(a), nv2a_reciprocal_of_sum(nv2a_f64_of_single(b)));
    if (nv2a_f64_is_nan(z) || nv2a_f64_less(z, 0ull) || nv2a_f64_less(0x416fffffe0000000ull, z)) return -1;
    return nv2a_int_of_f64(z);
}

/* Rule cull-fragment: whether a fragment is kept, by the modes of s, t, r and q. */
static inline int nv2a_cull_fragment(const uint32_t strq[4], const int modes[4]) {
    for (int k = 0; k < 4; k++) {
        uint32_t size = strq[k] & 0x7fffffffu;
        int below = (strq[k] & 0x80000000u) != 0u && size != 0u && size <= 0x7f800000u;
        if ((below != 0) != (modes[k] == NV2A_CULL_LESS)) return 0;
    }
    return 1;
}

#endif
