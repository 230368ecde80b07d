/* Whole numbers, and single and double precision by their bits: what the other files compute with.
 *
 * A single is a uint32_t, a double a uint64_t, with the bits of IEEE 754. Sums, products and quotients of doubles are
 * rounded to nearest, halves to even. NaN has the bits 0x7ff8000000000000 or 0x7fc00000. */
#ifndef NV2A_NUMBERS_H
#define NV2A_NUMBERS_H

#include <stdint.h>

/* x, within low and high. */
static inline int nv2a_clamp(int x, int low, int high) {
    return x < low ? low : x > high ? high : x;
}

/* The lesser. */
static inline int nv2a_least(int a, int b) {
    return a < b ? a : b;
}

/* The greater. */
static inline int nv2a_most(int a, int b) {
    return a > b ? a : b;
}

/* The place of the highest bit that is set, from 0; of 0 it is 0. */
static inline int nv2a_top_bit(uint32_t x) {
    int n = 0;
    if (x >= 0x10000u) { x >>= 16; n += 16; }
    if (x >= 0x100u) { x >>= 8; n += 8; }
    if (x >= 0x10u) { x >>= 4; n += 4; }
    if (x >= 0x4u) { x >>= 2; n += 2; }
    return x >= 0x2u ? n + 1 : n;
}

/* The same of 64 bits. */
static inline int nv2a_top_bit_64(uint64_t x) {
    uint32_t high = (uint32_t)(x >> 32);
    return high != 0u ? 32 + nv2a_top_bit(high) : nv2a_top_bit((uint32_t)x);
}

/* The upper 64 of the 128 bits of a b; their last bit is set where the lower ones are not all 0. */
static inline uint64_t nv2a_upper_product(uint64_t a, uint64_t b) {
    uint64_t al = a & 0xffffffffull, ah = a >> 32, bl = b & 0xffffffffull, bh = b >> 32;
    uint64_t low = al * bl, first = ah * bl, second = al * bh;
    uint64_t middle = (low >> 32) + (first & 0xffffffffull) + (second & 0xffffffffull);
    uint64_t high = ah * bh + (first >> 32) + (second >> 32) + (middle >> 32);
    uint64_t rest = (middle << 32) | (low & 0xffffffffull);
    return rest != 0ull ? high | 1ull : high;
}

/* ---------------------------------------------------------------------------------------- double precision */

/* The double nearest to m 2^e with that sign bit. The last bit of m stands for all that m lacks. */
static inline uint64_t nv2a_f64_round(uint64_t sign, int e, uint64_t m) {
    if (m == 0ull) return sign;
    int up = 63 - nv2a_top_bit_64(m);
    m <<= up;
    int biased = e - up + 63 + 1023;
    if (biased >= 2047) return sign | 0x7ff0000000000000ull;
    int dropped = 11;
    if (biased < 1) {
        dropped = 12 - biased;
        biased = 0;
        if (dropped > 63) return sign;
    }
    uint64_t kept = m >> dropped, rest = m << (64 - dropped);
    if (rest > 0x8000000000000000ull || (rest == 0x8000000000000000ull && (kept & 1ull) != 0ull)) kept += 1ull;
    if (biased > 0) kept += (uint64_t)(uint32_t)(biased - 1) << 52;
    return sign | kept;
}

static inline int nv2a_f64_is_nan(uint64_t a) {
    return (a & 0x7fffffffffffffffull) > 0x7ff0000000000000ull;
}

static inline int nv2a_f64_is_finite(uint64_t a) {
    return (a & 0x7ff0000000000000ull) != 0x7ff0000000000000ull;
}

static inline int nv2a_f64_is_zero(uint64_t a) {
    return (a << 1) == 0ull;
}

/* The least e with |a| < 2^e; of 0 it is 0. */
static inline int nv2a_f64_bound(uint64_t a) {
    int field = (int)(uint32_t)(a >> 52) & 2047;
    if (field != 0) return field - 1022;
    uint64_t m = a & 0x000fffffffffffffull;
    return m == 0ull ? 0 : nv2a_top_bit_64(m) - 1073;
}

/* The significand of a finite double: |a| is this times 2^nv2a_f64_unit(a). */
static inline uint64_t nv2a_f64_significand(uint64_t a) {
    uint64_t m = a & 0x000fffffffffffffull;
    return (a & 0x7ff0000000000000ull) != 0ull ? m | 0x0010000000000000ull : m;
}

static inline int nv2a_f64_unit(uint64_t a) {
    int field = (int)(uint32_t)(a >> 52) & 2047;
    return (field == 0 ? 1 : field) - 1075;
}

static inline uint64_t nv2a_f64_negated(uint64_t a) {
    return a ^ 0x8000000000000000ull;
}

static inline uint64_t nv2a_f64_magnitude(uint64_t a) {
    return a & 0x7fffffffffffffffull;
}

static inline uint64_t nv2a_f64_add(uint64_t a, uint64_t b) {
    if (nv2a_f64_is_nan(a) || nv2a_f64_is_nan(b)) return 0x7ff8000000000000ull;
    if (!nv2a_f64_is_finite(a)) {
        if (!nv2a_f64_is_finite(b) && a != b) return 0x7ff8000000000000ull;
        return a;
    }
    if (!nv2a_f64_is_finite(b)) return b;
    if (nv2a_f64_magnitude(a) < nv2a_f64_magnitude(b)) {
        uint64_t other = a;
        a = b;
        b = other;
    }
    uint64_t sign = a & 0x8000000000000000ull;
    uint64_t ma = nv2a_f64_significand(a) << 10, mb = nv2a_f64_significand(b) << 10;
    int apart = nv2a_f64_unit(a) - nv2a_f64_unit(b);
    if (apart > 63) {
        mb = mb != 0ull ? 1ull : 0ull;
    } else if (apart > 0) {
        uint64_t lost = mb << (64 - apart);
        mb >>= apart;
        if (lost != 0ull) mb |= 1ull;
    }
    int unit = nv2a_f64_unit(a) - 10;
    if (((a ^ b) & 0x8000000000000000ull) == 0ull) return nv2a_f64_round(sign, unit, ma + mb);
    return ma == mb ? 0ull : nv2a_f64_round(sign, unit, ma - mb);
}

static inline uint64_t nv2a_f64_subtract(uint64_t a, uint64_t b) {
    return nv2a_f64_add(a, nv2a_f64_negated(b));
}

static inline uint64_t nv2a_f64_multiply(uint64_t a, uint64_t b) {
    uint64_t sign = (a ^ b) & 0x8000000000000000ull;
    if (nv2a_f64_is_nan(a) || nv2a_f64_is_nan(b)) return 0x7ff8000000000000ull;
    if (!nv2a_f64_is_finite(a) || !nv2a_f64_is_finite(b)) {
        if (nv2a_f64_is_zero(a) || nv2a_f64_is_zero(b)) return 0x7ff8000000000000ull;
        return sign | 0x7ff0000000000000ull;
    }
    uint64_t ma = nv2a_f64_significand(a), mb = nv2a_f64_significand(b);
    if (ma == 0ull || mb == 0ull) return sign;
    int up = 63 - nv2a_top_bit_64(ma), over = 63 - nv2a_top_bit_64(mb);
    uint64_t m = nv2a_upper_product(ma << up, mb << over);
    return nv2a_f64_round(sign, nv2a_f64_unit(a) - up + nv2a_f64_unit(b) - over + 64, m);
}

static inline uint64_t nv2a_f64_divide(uint64_t a, uint64_t b) {
    uint64_t sign = (a ^ b) & 0x8000000000000000ull;
    if (nv2a_f64_is_nan(a) || nv2a_f64_is_nan(b)) return 0x7ff8000000000000ull;
    if (!nv2a_f64_is_finite(a)) return nv2a_f64_is_finite(b) ? sign | 0x7ff0000000000000ull : 0x7ff8000000000000ull;
    if (!nv2a_f64_is_finite(b)) return sign;
    uint64_t rest = nv2a_f64_significand(a), divisor = nv2a_f64_significand(b);
    if (divisor == 0ull) return rest == 0ull ? 0x7ff8000000000000ull : sign | 0x7ff0000000000000ull;
    if (rest == 0ull) return sign;
    int up = 52 - nv2a_top_bit_64(rest), over = 52 - nv2a_top_bit_64(divisor);
    rest <<= up;
    divisor <<= over;
    uint64_t quotient = 0ull;
    for (int k = 0; k < 56; k++) {
        quotient <<= 1;
        if (rest >= divisor) {
            rest -= divisor;
            quotient |= 1ull;
        }
        rest <<= 1;
    }
    if (rest != 0ull) quotient |= 1ull;
    return nv2a_f64_round(sign, nv2a_f64_unit(a) - up - nv2a_f64_unit(b) + over - 55, quotient);
}

/* a < b; false where one is NaN. */
static inline int nv2a_f64_less(uint64_t a, uint64_t b) {
    if (nv2a_f64_is_nan(a) || nv2a_f64_is_nan(b)) return 0;
    uint64_t ma = nv2a_f64_magnitude(a), mb = nv2a_f64_magnitude(b);
    int negative_a = ma != a && ma != 0ull, negative_b = mb != b && mb != 0ull;
    if (negative_a != negative_b) return negative_a;
    return negative_a ? mb < ma : ma < mb;
}

static inline uint64_t nv2a_f64_larger(uint64_t a, uint64_t b) {
    return nv2a_f64_less(a, b) ? b : a;
}

static inline uint64_t nv2a_f64_of_int(int n) {
    uint64_t sign = n < 0 ? 0x8000000000000000ull : 0ull;
    return nv2a_f64_round(sign, 0, (uint64_t)(n < 0 ? 0u - (uint32_t)n : (uint32_t)n));
}

static inline uint64_t nv2a_f64_of_int64(int64_t n) {
    uint64_t m = (uint64_t)n;
    if (n < (int64_t)0) return nv2a_f64_round(0x8000000000000000ull, 0, 0ull - m);
    return nv2a_f64_round(0ull, 0, m);
}

/* The double that a single is. */
static inline uint64_t nv2a_f64_of_single(uint32_t x) {
    uint64_t sign = (uint64_t)(x & 0x80000000u) << 32;
    uint32_t field = x >> 23 & 255u, fraction = x & 0x7fffffu;
    if (field == 255u) return fraction != 0u ? 0x7ff8000000000000ull : sign | 0x7ff0000000000000ull;
    if (field == 0u) return nv2a_f64_round(sign, -149, (uint64_t)fraction);
    return sign | (uint64_t)(field + 896u) << 52 | (uint64_t)fraction << 29;
}

/* The single that a double is, cut toward zero; 0 where it is below 2^-126, the largest where it is above. */
static inline uint32_t nv2a_single_of_f64(uint64_t a) {
    uint32_t sign = (uint32_t)(a >> 32) & 0x80000000u;
    if (nv2a_f64_is_nan(a)) return 0x7fc00000u;
    if (!nv2a_f64_is_finite(a)) return sign | 0x7f800000u;
    int field = ((int)(uint32_t)(a >> 52) & 2047) - 896;
    if (field < 1) return sign;
    if (field > 254) return sign | 0x7f7fffffu;
    return sign | (uint32_t)field << 23 | ((uint32_t)(a >> 29) & 0x7fffffu);
}

/* A double cut toward zero to so many significant bits, 1 to 53. */
static inline uint64_t nv2a_f64_cut(uint64_t a, int bits) {
    int dropped = 53 - bits;
    return a >> dropped << dropped;
}

/* A finite double cut toward zero to a multiple of 2^unit; it keeps its sign. */
static inline uint64_t nv2a_f64_multiple(uint64_t a, int unit) {
    int dropped = unit - nv2a_f64_unit(a);
    if (dropped <= 0) return a;
    if (dropped > 52) return a & 0x8000000000000000ull;
    return a >> dropped << dropped;
}

/* The largest whole number that is not above a. */
static inline uint64_t nv2a_f64_floor(uint64_t a) {
    if (!nv2a_f64_is_finite(a)) return a;
    uint64_t whole = nv2a_f64_multiple(a, 0);
    if (nv2a_f64_less(a, whole)) return nv2a_f64_add(whole, 0xbff0000000000000ull);
    return whole;
}

/* A finite double times 2^by, where neither is below double precision's normal numbers. */
static inline uint64_t nv2a_f64_scaled(uint64_t a, int by) {
    if (nv2a_f64_is_zero(a)) return a;
    return nv2a_f64_round(a & 0x8000000000000000ull, nv2a_f64_unit(a) + by, nv2a_f64_significand(a));
}

/* A double cut toward zero to a whole number, within -2^30 and 2^30; 0 for NaN. */
static inline int nv2a_int_of_f64(uint64_t a) {
    if (nv2a_f64_is_nan(a)) return 0;
    int n, bound = nv2a_f64_bound(a);
    if (bound > 30) n = 1 << 30;
    else if (bound < 1) n = 0;
    else n = (int)(uint32_t)(nv2a_f64_significand(a) >> (53 - bound));
    return (a & 0x8000000000000000ull) != 0ull ? -n : n;
}

/* The same, but not above a. */
static inline int nv2a_floor_of_f64(uint64_t a) {
    return nv2a_int_of_f64(nv2a_f64_floor(a));
}

/* The double that is nearest to a among singles, denormal ones too. */
static inline uint64_t nv2a_f64_to_single(uint64_t a) {
    if (!nv2a_f64_is_finite(a) || nv2a_f64_is_zero(a)) return a;
    int unit = nv2a_most(nv2a_f64_bound(a) - 24, -149);
    int dropped = unit - nv2a_f64_unit(a);
    uint64_t sign = a & 0x8000000000000000ull, m = nv2a_f64_significand(a);
    if (dropped <= 0) return a;
    if (dropped > 54) return sign;
    uint64_t kept = m >> dropped, rest = m - (kept << dropped), middle = 1ull << (dropped - 1);
    if (rest > middle || (rest == middle && (kept & 1ull) != 0ull)) kept += 1ull;
    uint64_t found = nv2a_f64_round(sign, unit, kept);
    return nv2a_f64_bound(found) > 128 ? sign | 0x7ff0000000000000ull : found;
}

#endif
