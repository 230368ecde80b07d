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
    int n = x >= 0x10000u ? 16 : 0;
    n += x >> n >= 0x100u ? 8 : 0;
    n += x >> n >= 0x10u ? 4 : 0;
    n += x >> n >= 0x4u ? 2 : 0;
    return n + (x >> n >= 0x2u ? 1 : 0);
}

/* The same of 64 bits. */
static inline int nv2a_top_bit_64(uint64_t x) {
    uint32_t high = (uint32_t)(x >> 32);
    return high != 0u ? 32 + nv2a_top_bit(high) : nv2a_top_bit((uint32_t)x);
}

/* The upper 64 of the 128 bits of a b; their last bit is set where the lower ones are not all 0. */
static inline uint64_t nv2a_upper_product(uint64_t a, uint64_t b) {
    uint32_t al = (uint32_t)a, ah = (uint32_t)(a >> 32), bl = (uint32_t)b, bh = (uint32_t)(b >> 32);
    uint64_t low = (uint64_t)al * (uint64_t)bl, first = (uint64_t)ah * (uint64_t)bl;
    uint64_t second = (uint64_t)al * (uint64_t)bh;
    uint64_t middle = (low >> 32) + (first & 0xffffffffull) + (second & 0xffffffffull);
    uint64_t high = (uint64_t)ah * (uint64_t)bh + (first >> 32) + (second >> 32) + (middle >> 32);
    return (uint32_t)middle != 0u || (uint32_t)low != 0u ? high | 1ull : high;
}

/* ---------------------------------------------------------------------------------------- double precision */

/* The double nearest to m 2^e with that sign bit. The last bit of m stands for all that m lacks. */
static inline uint64_t nv2a_f64_round(uint64_t sign, int e, uint64_t m) {
    int up = 63 - nv2a_top_bit_64(m), field = e - up + 1086;
    int dropped = field < 1 ? 12 - field : 11;
    uint64_t high = m << up, middle = 0x8000000000000000ull;
    uint64_t kept = dropped > 63 ? 0ull : high >> dropped;
    uint64_t rest = dropped > 64 ? 0ull : dropped == 64 ? high : high << (64 - dropped);
    if (rest > middle || (rest == middle && (kept & 1ull) != 0ull)) kept += 1ull;
    uint64_t found = kept + ((uint64_t)(uint32_t)(field > 0 ? field - 1 : 0) << 52);
    if (field >= 2047) found = 0x7ff0000000000000ull;
    return m == 0ull ? sign : sign | found;
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
    int swaps = nv2a_f64_magnitude(a) < nv2a_f64_magnitude(b);
    uint64_t large = swaps != 0 ? b : a, small = swaps != 0 ? a : b;
    uint64_t m = nv2a_f64_significand(large) << 10, other = nv2a_f64_significand(small) << 10;
    int unit = nv2a_f64_unit(large), by = nv2a_least(unit - nv2a_f64_unit(small), 63);
    uint64_t lost = by == 0 ? 0ull : other << (64 - by);
    int alike = ((a ^ b) & 0x8000000000000000ull) == 0ull;
    other = other >> by | (lost != 0ull ? 1ull : 0ull);
    uint64_t sum = alike != 0 ? m + other : m - other;
    uint64_t sign = sum == 0ull && alike == 0 ? 0ull : large & 0x8000000000000000ull;
    uint64_t found = nv2a_f64_round(sign, unit - 10, sum);
    if (!nv2a_f64_is_finite(large)) {
        found = nv2a_f64_is_nan(large) || (!nv2a_f64_is_finite(small) && alike == 0) ? 0x7ff8000000000000ull : large;
    }
    return found;
}

static inline uint64_t nv2a_f64_subtract(uint64_t a, uint64_t b) {
    return nv2a_f64_add(a, nv2a_f64_negated(b));
}

static inline uint64_t nv2a_f64_multiply(uint64_t a, uint64_t b) {
    uint64_t sign = (a ^ b) & 0x8000000000000000ull;
    uint64_t ma = nv2a_f64_significand(a), mb = nv2a_f64_significand(b);
    int up = 63 - nv2a_top_bit_64(ma), over = 63 - nv2a_top_bit_64(mb);
    uint64_t m = nv2a_upper_product(ma << up, mb << over);
    uint64_t found = nv2a_f64_round(sign, nv2a_f64_unit(a) - up + nv2a_f64_unit(b) - over + 64, m);
    if (!nv2a_f64_is_finite(a) || !nv2a_f64_is_finite(b)) {
        int none = nv2a_f64_is_nan(a) || nv2a_f64_is_nan(b) || nv2a_f64_is_zero(a) || nv2a_f64_is_zero(b);
        found = none != 0 ? 0x7ff8000000000000ull : sign | 0x7ff0000000000000ull;
    }
    return found;
}

static inline uint64_t nv2a_f64_divide(uint64_t a, uint64_t b) {
    uint64_t sign = (a ^ b) & 0x8000000000000000ull, quotient = 0ull;
    uint64_t ma = nv2a_f64_significand(a), mb = nv2a_f64_significand(b);
    int up = 52 - nv2a_top_bit_64(ma), over = 52 - nv2a_top_bit_64(mb);
    uint64_t rest = ma << up, divisor = mb << over;
    for (int k = 0; k < 56; k++) {
        int more = rest >= divisor;
        rest = (more != 0 ? rest - divisor : rest) << 1;
        quotient = quotient << 1 | (more != 0 ? 1ull : 0ull);
    }
    if (rest != 0ull) quotient = quotient | 1ull;
    uint64_t found = nv2a_f64_round(sign, nv2a_f64_unit(a) - up - nv2a_f64_unit(b) + over - 55, quotient);
    int none = nv2a_f64_is_nan(a) || nv2a_f64_is_nan(b);
    if (!nv2a_f64_is_finite(b)) found = sign;
    if (nv2a_f64_is_zero(b)) found = sign | 0x7ff0000000000000ull;
    if (!nv2a_f64_is_finite(a)) found = sign | 0x7ff0000000000000ull;
    if (nv2a_f64_is_zero(a) && nv2a_f64_is_zero(b)) none = 1;
    if (!nv2a_f64_is_finite(a) && !nv2a_f64_is_finite(b)) none = 1;
    return none != 0 ? 0x7ff8000000000000ull : found;
}

/* a < b; false where one is NaN. */
static inline int nv2a_f64_less(uint64_t a, uint64_t b) {
    uint64_t ma = nv2a_f64_magnitude(a), mb = nv2a_f64_magnitude(b);
    int below_a = ma != a && ma != 0ull, below_b = mb != b && mb != 0ull; /* 0 */
    int less = below_a != below_b ? below_a : below_a != 0 ? mb < ma : ma < mb;
    return less != 0 && !nv2a_f64_is_nan(a) && !nv2a_f64_is_nan(b);
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
    int negative = n < (int64_t)0;
    return nv2a_f64_round(negative ? 0x8000000000000000ull : 0ull, 0, negative ? 0ull - m : m);
}

/* The double that a single is. */
static inline uint64_t nv2a_f64_of_single(uint32_t x) {
    uint64_t sign = (uint64_t)(x & 0x80000000u) << 32;
    uint32_t field = x >> 23 & 255u, fraction = x & 0x7fffffu;
    int up = 23 - nv2a_top_bit(fraction); /* of a denormal number */
    uint32_t wide = field == 255u ? 2047u : field != 0u ? field + 896u : fraction == 0u ? 0u : (uint32_t)(897 - up);
    if (field == 0u) fraction = fraction << up & 0x7fffffu;
    if (field == 255u && fraction != 0u) return 0x7ff8000000000000ull;
    return sign | (uint64_t)wide << 52 | (uint64_t)fraction << 29;
}

/* The single that a double is, cut toward zero; 0 where it is below 2^-126, the largest where it is above. */
static inline uint32_t nv2a_single_of_f64(uint64_t a) {
    uint32_t sign = (uint32_t)(a >> 32) & 0x80000000u, fraction = (uint32_t)(a >> 29) & 0x7fffffu;
    int field = ((int)(uint32_t)(a >> 52) & 2047) - 896;
    uint32_t found = (uint32_t)nv2a_clamp(field, 0, 254) << 23 | (field > 254 ? 0x7fffffu : fraction);
    if (field < 1) found = 0u;
    if (!nv2a_f64_is_finite(a)) found = 0x7f800000u;
    return nv2a_f64_is_nan(a) ? 0x7fc00000u : sign | found;
}

/* A double cut toward zero to so many significant bits, 1 to 53. */
static inline uint64_t nv2a_f64_cut(uint64_t a, int bits) {
    int dropped = 53 - bits;
    return a >> dropped << dropped;
}

/* A finite double cut toward zero to a multiple of 2^unit; it keeps its sign. */
static inline uint64_t nv2a_f64_multiple(uint64_t a, int unit) {
    int dropped = unit - nv2a_f64_unit(a), by = nv2a_clamp(dropped, 0, 63);
    return dropped > 52 ? a & 0x8000000000000000ull : a >> by << by;
}

/* a b of numbers of 32 significant bits at most: exact where there are 53 together, else cut toward zero. Neither
 * product nor factors are below double precision's normal numbers, or infinite, or NaN. */
static inline uint64_t nv2a_f64_product(uint64_t a, uint64_t b) {
    uint64_t sign = (a ^ b) & 0x8000000000000000ull;
    uint32_t ma = (uint32_t)(a >> 21) | 0x80000000u, mb = (uint32_t)(b >> 21) | 0x80000000u;
    uint64_t m = (uint64_t)ma * (uint64_t)mb;
    uint32_t over = (uint32_t)(m >> 63);
    uint32_t field = ((uint32_t)(a >> 52) & 2047u) + ((uint32_t)(b >> 52) & 2047u) - 1023u + over;
    uint64_t found = (uint64_t)field << 52 | (m >> (int)(10u + over) & 0x000fffffffffffffull);
    return nv2a_f64_is_zero(a) || nv2a_f64_is_zero(b) ? sign : sign | found;
}

/* How many times 2^unit a finite number has, cut toward zero; they are fewer than 2^62. */
static inline int64_t nv2a_f64_in_units(uint64_t a, int unit) {
    int down = unit - nv2a_f64_unit(a);
    uint64_t m = nv2a_f64_significand(a) << nv2a_clamp(-down, 0, 63) >> nv2a_clamp(down, 0, 63);
    return (a & 0x8000000000000000ull) != 0ull ? (int64_t)0 - (int64_t)m : (int64_t)m;
}

/* So many times 2^unit, cut toward zero to so many significant bits. */
static inline uint64_t nv2a_f64_of_units(int64_t n, int unit, int bits) {
    int below = n < (int64_t)0;
    uint64_t m = below != 0 ? 0ull - (uint64_t)n : (uint64_t)n;
    int top = nv2a_top_bit_64(m), field = nv2a_clamp(unit + top + 1023, 0, 2047);
    uint64_t fraction = m << (63 - top) >> (64 - bits) << (53 - bits) & 0x000fffffffffffffull;
    uint64_t found = (uint64_t)(uint32_t)field << 52 | (field < 2047 ? fraction : 0ull);
    if (m == 0ull || field == 0) found = 0ull;
    return below != 0 && found != 0ull ? found | 0x8000000000000000ull : found;
}

/* The largest whole number that is not above a. */
static inline uint64_t nv2a_f64_floor(uint64_t a) {
    uint64_t whole = nv2a_f64_multiple(a, 0);
    if (nv2a_f64_less(a, whole)) whole = nv2a_f64_add(whole, 0xbff0000000000000ull);
    return nv2a_f64_is_finite(a) ? whole : a;
}

/* A finite double times 2^by, where neither is below double precision's normal numbers. */
static inline uint64_t nv2a_f64_scaled(uint64_t a, int by) {
    if (nv2a_f64_is_zero(a)) return a;
    return nv2a_f64_round(a & 0x8000000000000000ull, nv2a_f64_unit(a) + by, nv2a_f64_significand(a));
}

/* A double cut toward zero to a whole number, within -2^30 and 2^30; 0 for NaN. */
static inline int nv2a_int_of_f64(uint64_t a) {
    int bound = nv2a_f64_bound(a);
    int n = (int)(uint32_t)(nv2a_f64_significand(a) >> nv2a_clamp(53 - bound, 0, 63));
    if (bound > 30) n = 1 << 30;
    if (bound < 1 || nv2a_f64_is_nan(a)) n = 0;
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
