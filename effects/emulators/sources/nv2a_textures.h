/* Where a texture is read, how its texels are filtered, and cube maps: docs/numbers.md, N6.8 to N6.10 and N7.7. */
#ifndef NV2A_TEXTURES_H
#define NV2A_TEXTURES_H

#include "nv2a_numbers.h"

/* Source: NV097_SET_TEXTURE_ADDRESS. */
enum {
    NV2A_WRAP_REPEAT = 1,
    NV2A_WRAP_MIRRORED_REPEAT = 2,
    NV2A_WRAP_CLAMP_TO_EDGE = 3,
    NV2A_WRAP_CLAMP_TO_BORDER = 4,
    NV2A_WRAP_CLAMP = 5
};

/* t, in texels, brought into the range of an axis of so many; what is not a number becomes its lower end. */
static inline uint64_t nv2a_wrapped(uint64_t t, int size, int wrap) {
    uint64_t n = nv2a_f64_of_int(size), low = 0ull, high = n, middle = 0x3fe0000000000000ull;
    if (wrap == NV2A_WRAP_MIRRORED_REPEAT) high = nv2a_f64_of_int(2 * size);
    if (wrap == NV2A_WRAP_CLAMP_TO_EDGE) {
        low = middle;
        high = nv2a_f64_subtract(n, middle);
    }
    if (wrap == NV2A_WRAP_CLAMP_TO_BORDER) {
        low = nv2a_f64_negated(middle);
        high = nv2a_f64_add(n, middle);
    }
    if (wrap == NV2A_WRAP_REPEAT || wrap == NV2A_WRAP_MIRRORED_REPEAT) {
        uint64_t turns = nv2a_f64_multiply(t, nv2a_f64_divide(0x3ff0000000000000ull, high));
        t = nv2a_f64_subtract(t, nv2a_f64_multiply(high, nv2a_f64_floor(turns)));
    }
    if (!nv2a_f64_less(low, t)) return low;
    return nv2a_f64_less(t, high) ? t : high;
}

/* The texel of a whole number beside a wrapped coordinate: 0 to size - 1, or -1, the border's colour. */
static inline int nv2a_texel_index(int i, int size, int wrap, int linear) {
    int turn = wrap == NV2A_WRAP_MIRRORED_REPEAT ? 2 * size : size;
    if (wrap == NV2A_WRAP_REPEAT || wrap == NV2A_WRAP_MIRRORED_REPEAT) {
        if (i < 0) i += turn;
        if (i >= turn) i -= turn;
        return i < size ? i : turn - 1 - i;
    }
    if (wrap == NV2A_WRAP_CLAMP_TO_BORDER || (wrap == NV2A_WRAP_CLAMP && linear != 0)) {
        return i < 0 || i >= size ? -1 : i;
    }
    return nv2a_clamp(i, 0, size - 1);
}

/* Rule nearest-texel: t in texels. */
static inline int nv2a_nearest_texel(uint64_t t, int size, int wrap) {
    return nv2a_texel_index(nv2a_floor_of_f64(nv2a_wrapped(t, size, wrap)), size, wrap, 0);
}

/* Rule linear-texels: two texels, and the second's weight in 256ths. */
static inline void nv2a_linear_texels(uint64_t t, int size, int wrap, int result[3]) {
    uint64_t from = nv2a_f64_subtract(nv2a_wrapped(t, size, wrap), 0x3fe0000000000000ull);
    int at = nv2a_floor_of_f64(nv2a_f64_multiply(from, 0x4070000000000000ull));
    result[0] = nv2a_texel_index(at >> 8, size, wrap, 1);
    result[1] = nv2a_texel_index((at >> 8) + 1, size, wrap, 1);
    result[2] = at & 255;
}

/* From p to q by f of 256. */
static inline int nv2a_filter_step(int p, int q, int f) {
    return (p * (256 - f) + q * f + 128) >> 8;
}

/* One component of four texels: along s by a, then along t by b. */
static inline int nv2a_bilinear(int p00, int p10, int p01, int p11, int a, int b) {
    return nv2a_filter_step(nv2a_filter_step(p00, p10, a), nv2a_filter_step(p01, p11, a), b);
}

/* The same of all four components. */
static inline void nv2a_bilinear_texel(
    const int p00[4], const int p10[4], const int p01[4], const int p11[4], int a, int b, int result[4]) {
    for (int k = 0; k < 4; k++) result[k] = nv2a_bilinear(p00[k], p10[k], p01[k], p11[k], a, b);
}

/* Two levels' texels, by the second's weight of 256. */
static inline void nv2a_between_levels(const int level[4], const int next[4], int f, int result[4]) {
    for (int k = 0; k < 4; k++) result[k] = nv2a_filter_step(level[k], next[k], f);
}

/* 2^(k/128) as doubles. */
static const uint64_t nv2a_octave[128] = {
    0x3ff0000000000000ull, 0x3ff0163da9fb3335ull, 0x3ff02c9a3e778061ull, 0x3ff04315e86e7f85ull,
    0x3ff059b0d3158574ull, 0x3ff0706b29ddf6deull, 0x3ff0874518759bc8ull, 0x3ff09e3ecac6f383ull,
    0x3ff0b5586cf9890full, 0x3ff0cc922b7247f7ull, 0x3ff0e3ec32d3d1a2ull, 0x3ff0fb66affed31bull,
    0x3ff11301d0125b51ull, 0x3ff12abdc06c31ccull, 0x3ff1429aaea92de0ull, 0x3ff15a98c8a58e51ull,
    0x3ff172b83c7d517bull, 0x3ff18af9388c8deaull, 0x3ff1a35beb6fcb75ull, 0x3ff1bbe084045cd4ull,
    0x3ff1d4873168b9aaull, 0x3ff1ed5022fcd91dull, 0x3ff2063b88628cd6ull, 0x3ff21f49917ddc96ull,
    0x3ff2387a6e756238ull, 0x3ff251ce4fb2a63full, 0x3ff26b4565e27cddull, 0x3ff284dfe1f56381ull,
    0x3ff29e9df51fdee1ull, 0x3ff2b87fd0dad990ull, 0x3ff2d285a6e4030bull, 0x3ff2ecafa93e2f56ull,
    0x3ff306fe0a31b715ull, 0x3ff32170fc4cd831ull, 0x3ff33c08b26416ffull, 0x3ff356c55f929ff1ull,
    0x3ff371a7373aa9cbull, 0x3ff38cae6d05d866ull, 0x3ff3a7db34e59ff7ull, 0x3ff3c32dc313a8e5ull,
    0x3ff3dea64c123422ull, 0x3ff3fa4504ac801cull, 0x3ff4160a21f72e2aull, 0x3ff431f5d950a897ull,
    0x3ff44e086061892dull, 0x3ff46a41ed1d0057ull, 0x3ff486a2b5c13cd0ull, 0x3ff4a32af0d7d3deull,
    0x3ff4bfdad5362a27ull, 0x3ff4dcb299fddd0dull, 0x3ff4f9b2769d2ca7ull, 0x3ff516daa2cf6642ull,
    0x3ff5342b569d4f82ull, 0x3ff551a4ca5d920full, 0x3ff56f4736b527daull, 0x3ff58d12d497c7fdull,
    0x3ff5ab07dd485429ull, 0x3ff5c9268a5946b7ull, 0x3ff5e76f15ad2148ull, 0x3ff605e1b976dc09ull,
    0x3ff6247eb03a5585ull, 0x3ff6434634ccc320ull, 0x3ff6623882552225ull, 0x3ff68155d44ca973ull,
    0x3ff6a09e667f3bcdull, 0x3ff6c012750bdabfull, 0x3ff6dfb23c651a2full, 0x3ff6ff7df9519484ull,
    0x3ff71f75e8ec5f74ull, 0x3ff73f9a48a58174ull, 0x3ff75feb564267c9ull, 0x3ff780694fde5d3full,
    0x3ff7a11473eb0187ull, 0x3ff7c1ed0130c132ull, 0x3ff7e2f336cf4e62ull, 0x3ff80427543e1a12ull,
    0x3ff82589994cce13ull, 0x3ff8471a4623c7adull, 0x3ff868d99b4492edull, 0x3ff88ac7d98a6699ull,
    0x3ff8ace5422aa0dbull, 0x3ff8cf3216b5448cull, 0x3ff8f1ae99157736ull, 0x3ff9145b0b91ffc6ull,
    0x3ff93737b0cdc5e5ull, 0x3ff95a44cbc8520full, 0x3ff97d829fde4e50ull, 0x3ff9a0f170ca07baull,
    0x3ff9c49182a3f090ull, 0x3ff9e86319e32323ull, 0x3ffa0c667b5de565ull, 0x3ffa309bec4a2d33ull,
    0x3ffa5503b23e255dull, 0x3ffa799e1330b358ull, 0x3ffa9e6b5579fdbfull, 0x3ffac36bbfd3f37aull,
    0x3ffae89f995ad3adull, 0x3ffb0e07298db666ull, 0x3ffb33a2b84f15fbull, 0x3ffb59728de5593aull,
    0x3ffb7f76f2fb5e47ull, 0x3ffba5b030a1064aull, 0x3ffbcc1e904bc1d2ull, 0x3ffbf2c25bd71e09ull,
    0x3ffc199bdd85529cull, 0x3ffc40ab5fffd07aull, 0x3ffc67f12e57d14bull, 0x3ffc8f6d9406e7b5ull,
    0x3ffcb720dcef9069ull, 0x3ffcdf0b555dc3faull, 0x3ffd072d4a07897cull, 0x3ffd2f87080d89f2ull,
    0x3ffd5818dcfba487ull, 0x3ffd80e316c98398ull, 0x3ffda9e603db3285ull, 0x3ffdd321f301b460ull,
    0x3ffdfc97337b9b5full, 0x3ffe264614f5a129ull, 0x3ffe502ee78b3ff6ull, 0x3ffe7a51fbc74c83ull,
    0x3ffea4afa2a490daull, 0x3ffecf482d8e67f1ull, 0x3ffefa1bee615a27ull, 0x3fff252b376bba97ull,
    0x3fff50765b6e4540ull, 0x3fff7bfdad9cbe14ull, 0x3fffa7c1819e90d8ull, 0x3fffd3c22b8f71f1ull
};

/* Rule lambda: floor(128 log2(rho2)) of a positive finite double. */
static inline int nv2a_lambda(uint64_t rho2) {
    uint64_t m = nv2a_f64_significand(rho2);
    m = (m << (52 - nv2a_top_bit_64(m)) & 0x000fffffffffffffull) | 0x3ff0000000000000ull;
    int k = 0;
    for (int by = 64; by > 0; by = by >> 1) {
        if (m >= nv2a_octave[k + by]) k += by;
    }
    return 128 * (nv2a_f64_bound(rho2) - 1) + k;
}

/* --------------------------------------------------------------------------------------------- cube maps */

/* Rule cube-face: +x, -x, +y, -y, +z, -z are 0 to 5. */
static inline int nv2a_cube_face(uint32_t s, uint32_t t, uint32_t r) {
    uint32_t x = s & 0x7fffffffu, y = t & 0x7fffffffu, z = r & 0x7fffffffu;
    if (x >= y && x >= z) return (s & 0x80000000u) != 0u && x != 0u ? 1 : 0;
    if (y >= z) return (t & 0x80000000u) != 0u ? 3 : 2;
    return (r & 0x80000000u) != 0u ? 5 : 4;
}

/* A face's coordinate of one component, in texels of an edge of so many; lifted over double precision's noise. */
static inline uint64_t nv2a_face_coordinate(uint32_t c, uint32_t major, int size) {
    uint64_t lift = 0x3e70000000000000ull;
    if ((major & 0x7fffffffu) == 0u) return lift;
    uint64_t quotient = nv2a_f64_divide(nv2a_f64_of_single(c), nv2a_f64_of_single(major & 0x7fffffffu));
    uint64_t reach = nv2a_f64_multiply(nv2a_f64_of_int(size), 0x3fe0000000000000ull);
    return nv2a_f64_add(nv2a_f64_multiply(nv2a_f64_add(quotient, 0x3ff0000000000000ull), reach), lift);
}

/* s and t on the direction's face of so many texels an edge. */
static inline void nv2a_cube_coordinates(uint32_t s, uint32_t t, uint32_t r, int size, uint64_t result[2]) {
    int face = nv2a_cube_face(s, t, r);
    uint32_t minus = 0x80000000u, sc = s, tc = t ^ minus, major = r;
    if (face == 0) { sc = r ^ minus; major = s; }
    if (face == 1) { sc = r; major = s; }
    if (face == 2) { tc = r; major = t; }
    if (face == 3) { tc = r ^ minus; major = t; }
    if (face == 5) { sc = s ^ minus; }
    result[0] = nv2a_face_coordinate(sc, major, size);
    result[1] = nv2a_face_coordinate(tc, major, size);
}

/* Rule cube-texel: the same of 64 texels an edge. */
static inline void nv2a_cube_texel(uint32_t s, uint32_t t, uint32_t r, uint64_t result[2]) {
    nv2a_cube_coordinates(s, t, r, 64, result);
}

#endif
