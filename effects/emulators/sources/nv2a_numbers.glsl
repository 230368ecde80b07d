// Whole numbers, and single and double precision by their bits: what the other files compute with.
//
// A single is a uint32_t, a double a uint64_t, with the bits of IEEE 754. Sums, products and quotients of doubles are
// rounded to nearest, halves to even. NaN has the bits 0x7ff8000000000000 or 0x7fc00000.

// x, within low and high.
int nv2a_clamp(int x, int low, int high) {
    return x < low ? low : x > high ? high : x;
}

// The lesser.
int nv2a_least(int a, int b) {
    return a < b ? a : b;
}

// The greater.
int nv2a_most(int a, int b) {
    return a > b ? a : b;
}

// The place of the highest bit that is set, from 0; of 0 it is 0.
int nv2a_top_bit(uint x) {
    int n = x >= 0x10000u ? 16 : 0;
    n += x >> n >= 0x100u ? 8 : 0;
    n += x >> n >= 0x10u ? 4 : 0;
    n += x >> n >= 0x4u ? 2 : 0;
    return n + (x >> n >= 0x2u ? 1 : 0);
}

// The same of 64 bits.
int nv2a_top_bit_64(uvec2 x) {
    uint high = nv2a_u64_right(x, 32).x;
    return high != 0u ? 32 + nv2a_top_bit(high) : nv2a_top_bit(x.x);
}

// The upper 64 of the 128 bits of a b; their last bit is set where the lower ones are not all 0.
uvec2 nv2a_upper_product(uvec2 a, uvec2 b) {
    uint al = a.x;
    uint ah = nv2a_u64_right(a, 32).x;
    uint bl = b.x;
    uint bh = nv2a_u64_right(b, 32).x;
    uvec2 low = nv2a_u32_product(al, bl);
    uvec2 first = nv2a_u32_product(ah, bl);
    uvec2 second = nv2a_u32_product(al, bh);
    uvec2 middle = nv2a_u64_add(nv2a_u64_add(nv2a_u64_right(low, 32), first & uvec2(0xffffffffu, 0x0u)),
        second & uvec2(0xffffffffu, 0x0u));
    uvec2 high = nv2a_u64_add(nv2a_u64_add(nv2a_u64_add(nv2a_u32_product(ah, bh), nv2a_u64_right(first, 32)),
        nv2a_u64_right(second, 32)), nv2a_u64_right(middle, 32));
    return middle.x != 0u || low.x != 0u ? high | uvec2(0x1u, 0x0u) : high;
}

// The double nearest to m 2^e with that sign bit. The last bit of m stands for all that m lacks.
uvec2 nv2a_f64_round(uvec2 sign, int e, uvec2 m) {
    int up = 63 - nv2a_top_bit_64(m);
    int field = e - up + 1086;
    int dropped = field < 1 ? 12 - field : 11;
    uvec2 high = nv2a_u64_left(m, up);
    uvec2 middle = uvec2(0x0u, 0x80000000u);
    uvec2 kept = dropped > 63 ? uvec2(0x0u, 0x0u) : nv2a_u64_right(high, dropped);
    uvec2 rest = dropped > 64 ? uvec2(0x0u, 0x0u) : dropped == 64 ? high : nv2a_u64_left(high, 64 - dropped);
    if (nv2a_u64_less(middle, rest) || (rest == middle && (kept & uvec2(0x1u, 0x0u)) != uvec2(0x0u, 0x0u))) {
        kept = nv2a_u64_add(kept, uvec2(0x1u, 0x0u));
    }
    uvec2 found = nv2a_u64_add(kept, nv2a_u64_left(uvec2(uint(field > 0 ? field - 1 : 0), 0u), 52));
    if (field >= 2047) {
        found = uvec2(0x0u, 0x7ff00000u);
    }
    return m == uvec2(0x0u, 0x0u) ? sign : sign | found;
}

int nv2a_f64_is_nan(uvec2 a) {
    return int(nv2a_u64_less(uvec2(0x0u, 0x7ff00000u), a & uvec2(0xffffffffu, 0x7fffffffu)));
}

int nv2a_f64_is_finite(uvec2 a) {
    return int((a & uvec2(0x0u, 0x7ff00000u)) != uvec2(0x0u, 0x7ff00000u));
}

int nv2a_f64_is_zero(uvec2 a) {
    return int(nv2a_u64_left(a, 1) == uvec2(0x0u, 0x0u));
}

// The least e with |a| < 2^e; of 0 it is 0.
int nv2a_f64_bound(uvec2 a) {
    int field = int(nv2a_u64_right(a, 52).x) & 2047;
    if (field != 0) {
        return field - 1022;
    }
    uvec2 m = a & uvec2(0xffffffffu, 0xfffffu);
    return m == uvec2(0x0u, 0x0u) ? 0 : nv2a_top_bit_64(m) - 1073;
}

// The significand of a finite double: |a| is this times 2^nv2a_f64_unit(a).
uvec2 nv2a_f64_significand(uvec2 a) {
    uvec2 m = a & uvec2(0xffffffffu, 0xfffffu);
    return (a & uvec2(0x0u, 0x7ff00000u)) != uvec2(0x0u, 0x0u) ? m | uvec2(0x0u, 0x100000u) : m;
}

int nv2a_f64_unit(uvec2 a) {
    int field = int(nv2a_u64_right(a, 52).x) & 2047;
    return (field == 0 ? 1 : field) - 1075;
}

uvec2 nv2a_f64_negated(uvec2 a) {
    return a ^ uvec2(0x0u, 0x80000000u);
}

uvec2 nv2a_f64_magnitude(uvec2 a) {
    return a & uvec2(0xffffffffu, 0x7fffffffu);
}

uvec2 nv2a_f64_add(uvec2 a, uvec2 b) {
    int swaps = int(nv2a_u64_less(nv2a_f64_magnitude(a), nv2a_f64_magnitude(b)));
    uvec2 large = swaps != 0 ? b : a;
    uvec2 small = swaps != 0 ? a : b;
    uvec2 m = nv2a_u64_left(nv2a_f64_significand(large), 10);
    uvec2 other = nv2a_u64_left(nv2a_f64_significand(small), 10);
    int unit = nv2a_f64_unit(large);
    int by = nv2a_least(unit - nv2a_f64_unit(small), 63);
    uvec2 lost = by == 0 ? uvec2(0x0u, 0x0u) : nv2a_u64_left(other, 64 - by);
    int alike = int(((a ^ b) & uvec2(0x0u, 0x80000000u)) == uvec2(0x0u, 0x0u));
    other = nv2a_u64_right(other, by) | (lost != uvec2(0x0u, 0x0u) ? uvec2(0x1u, 0x0u) : uvec2(0x0u, 0x0u));
    uvec2 sum = alike != 0 ? nv2a_u64_add(m, other) : nv2a_u64_subtract(m, other);
    uvec2 sign = sum == uvec2(0x0u, 0x0u) && alike == 0 ? uvec2(0x0u, 0x0u) : large & uvec2(0x0u, 0x80000000u);
    uvec2 found = nv2a_f64_round(sign, unit - 10, sum);
    if (!(nv2a_f64_is_finite(large) != 0)) {
        found = nv2a_f64_is_nan(large) != 0 || (!(nv2a_f64_is_finite(small) != 0) && alike == 0) ? uvec2(0x0u,
            0x7ff80000u) : large;
    }
    return found;
}

uvec2 nv2a_f64_subtract(uvec2 a, uvec2 b) {
    return nv2a_f64_add(a, nv2a_f64_negated(b));
}

uvec2 nv2a_f64_multiply(uvec2 a, uvec2 b) {
    uvec2 sign = (a ^ b) & uvec2(0x0u, 0x80000000u);
    uvec2 ma = nv2a_f64_significand(a);
    uvec2 mb = nv2a_f64_significand(b);
    int up = 63 - nv2a_top_bit_64(ma);
    int over = 63 - nv2a_top_bit_64(mb);
    uvec2 m = nv2a_upper_product(nv2a_u64_left(ma, up), nv2a_u64_left(mb, over));
    uvec2 found = nv2a_f64_round(sign, nv2a_f64_unit(a) - up + nv2a_f64_unit(b) - over + 64, m);
    if (!(nv2a_f64_is_finite(a) != 0) || !(nv2a_f64_is_finite(b) != 0)) {
        int none = int(nv2a_f64_is_nan(a) != 0 || nv2a_f64_is_nan(b) != 0 || nv2a_f64_is_zero(a) != 0
            || nv2a_f64_is_zero(b) != 0);
        found = none != 0 ? uvec2(0x0u, 0x7ff80000u) : sign | uvec2(0x0u, 0x7ff00000u);
    }
    return found;
}

uvec2 nv2a_f64_divide(uvec2 a, uvec2 b) {
    uvec2 sign = (a ^ b) & uvec2(0x0u, 0x80000000u);
    uvec2 quotient = uvec2(0x0u, 0x0u);
    uvec2 ma = nv2a_f64_significand(a);
    uvec2 mb = nv2a_f64_significand(b);
    int up = 52 - nv2a_top_bit_64(ma);
    int over = 52 - nv2a_top_bit_64(mb);
    uvec2 rest = nv2a_u64_left(ma, up);
    uvec2 divisor = nv2a_u64_left(mb, over);
    for (int k = 0; k < 56; k++) {
        int more = int(!nv2a_u64_less(rest, divisor));
        rest = nv2a_u64_left(more != 0 ? nv2a_u64_subtract(rest, divisor) : rest, 1);
        quotient = nv2a_u64_left(quotient, 1) | (more != 0 ? uvec2(0x1u, 0x0u) : uvec2(0x0u, 0x0u));
    }
    if (rest != uvec2(0x0u, 0x0u)) {
        quotient = quotient | uvec2(0x1u, 0x0u);
    }
    uvec2 found = nv2a_f64_round(sign, nv2a_f64_unit(a) - up - nv2a_f64_unit(b) + over - 55, quotient);
    int none = int(nv2a_f64_is_nan(a) != 0 || nv2a_f64_is_nan(b) != 0);
    if (!(nv2a_f64_is_finite(b) != 0)) {
        found = sign;
    }
    if (nv2a_f64_is_zero(b) != 0) {
        found = sign | uvec2(0x0u, 0x7ff00000u);
    }
    if (!(nv2a_f64_is_finite(a) != 0)) {
        found = sign | uvec2(0x0u, 0x7ff00000u);
    }
    if (nv2a_f64_is_zero(a) != 0 && nv2a_f64_is_zero(b) != 0) {
        none = 1;
    }
    if (!(nv2a_f64_is_finite(a) != 0) && !(nv2a_f64_is_finite(b) != 0)) {
        none = 1;
    }
    return none != 0 ? uvec2(0x0u, 0x7ff80000u) : found;
}

// a < b; false where one is NaN.
int nv2a_f64_less(uvec2 a, uvec2 b) {
    uvec2 ma = nv2a_f64_magnitude(a);
    uvec2 mb = nv2a_f64_magnitude(b);
    int below_a = int(ma != a && ma != uvec2(0x0u, 0x0u));
    int below_b = int(mb != b && mb != uvec2(0x0u, 0x0u));
    int less = below_a != below_b ? below_a : int(below_a != 0 ? nv2a_u64_less(mb, ma) : nv2a_u64_less(ma, mb));
    return int(less != 0 && !(nv2a_f64_is_nan(a) != 0) && !(nv2a_f64_is_nan(b) != 0));
}

uvec2 nv2a_f64_larger(uvec2 a, uvec2 b) {
    return nv2a_f64_less(a, b) != 0 ? b : a;
}

uvec2 nv2a_f64_of_int(int n) {
    uvec2 sign = n < 0 ? uvec2(0x0u, 0x80000000u) : uvec2(0x0u, 0x0u);
    return nv2a_f64_round(sign, 0, uvec2(n < 0 ? 0u - uint(n) : uint(n), 0u));
}

uvec2 nv2a_f64_of_int64(uvec2 n) {
    uvec2 m = n;
    int negative = int(nv2a_i64_less(n, uvec2(0u, 0u)));
    return nv2a_f64_round(negative != 0 ? uvec2(0x0u, 0x80000000u) : uvec2(0x0u, 0x0u), 0, negative != 0
        ? nv2a_u64_subtract(uvec2(0x0u, 0x0u), m) : m);
}

// The double that a single is.
uvec2 nv2a_f64_of_single(uint x) {
    uvec2 sign = nv2a_u64_left(uvec2(x & 0x80000000u, 0u), 32);
    uint field = (x >> 23) & 255u;
    uint fraction = x & 0x7fffffu;
    int up = 23 - nv2a_top_bit(fraction);
    uint wide = field == 255u ? 2047u : field != 0u ? field + 896u : fraction == 0u ? 0u : uint(897 - up);
    if (field == 0u) {
        fraction = (fraction << up) & 0x7fffffu;
    }
    if (field == 255u && fraction != 0u) {
        return uvec2(0x0u, 0x7ff80000u);
    }
    return sign | nv2a_u64_left(uvec2(wide, 0u), 52) | nv2a_u64_left(uvec2(fraction, 0u), 29);
}

// The single that a double is, cut toward zero; 0 where it is below 2^-126, the largest where it is above.
uint nv2a_single_of_f64(uvec2 a) {
    uint sign = nv2a_u64_right(a, 32).x & 0x80000000u;
    uint fraction = nv2a_u64_right(a, 29).x & 0x7fffffu;
    int field = (int(nv2a_u64_right(a, 52).x) & 2047) - 896;
    uint found = (uint(nv2a_clamp(field, 0, 254)) << 23) | (field > 254 ? 0x7fffffu : fraction);
    if (field < 1) {
        found = 0u;
    }
    if (!(nv2a_f64_is_finite(a) != 0)) {
        found = 0x7f800000u;
    }
    return nv2a_f64_is_nan(a) != 0 ? 0x7fc00000u : sign | found;
}

// A double cut toward zero to so many significant bits, 1 to 53.
uvec2 nv2a_f64_cut(uvec2 a, int bits) {
    int dropped = 53 - bits;
    return nv2a_u64_left(nv2a_u64_right(a, dropped), dropped);
}

// A finite double cut toward zero to a multiple of 2^unit; it keeps its sign.
uvec2 nv2a_f64_multiple(uvec2 a, int unit) {
    int dropped = unit - nv2a_f64_unit(a);
    int by = nv2a_clamp(dropped, 0, 63);
    return dropped > 52 ? a & uvec2(0x0u, 0x80000000u) : nv2a_u64_left(nv2a_u64_right(a, by), by);
}

// a b of numbers of 32 significant bits at most: exact where there are 53 together, else cut toward zero. Neither
// product nor factors are below double precision's normal numbers, or infinite, or NaN.
uvec2 nv2a_f64_product(uvec2 a, uvec2 b) {
    uvec2 sign = (a ^ b) & uvec2(0x0u, 0x80000000u);
    uint ma = nv2a_u64_right(a, 21).x | 0x80000000u;
    uint mb = nv2a_u64_right(b, 21).x | 0x80000000u;
    uvec2 m = nv2a_u32_product(ma, mb);
    uint over = nv2a_u64_right(m, 63).x;
    uint field = (nv2a_u64_right(a, 52).x & 2047u) + (nv2a_u64_right(b, 52).x & 2047u) - 1023u + over;
    uvec2 found = nv2a_u64_left(uvec2(field, 0u), 52) | (nv2a_u64_right(m, int(10u + over)) & uvec2(0xffffffffu,
        0xfffffu));
    return nv2a_f64_is_zero(a) != 0 || nv2a_f64_is_zero(b) != 0 ? sign : sign | found;
}

// How many times 2^unit a finite number has, cut toward zero; they are fewer than 2^62.
uvec2 nv2a_f64_in_units(uvec2 a, int unit) {
    int down = unit - nv2a_f64_unit(a);
    uvec2 m = nv2a_u64_right(nv2a_u64_left(nv2a_f64_significand(a), nv2a_clamp(-down, 0, 63)), nv2a_clamp(down, 0,
        63));
    return (a & uvec2(0x0u, 0x80000000u)) != uvec2(0x0u, 0x0u) ? nv2a_u64_subtract(uvec2(0u, 0u), m) : m;
}

// So many times 2^unit, cut toward zero to so many significant bits.
uvec2 nv2a_f64_of_units(uvec2 n, int unit, int bits) {
    int below = int(nv2a_i64_less(n, uvec2(0u, 0u)));
    uvec2 m = below != 0 ? nv2a_u64_subtract(uvec2(0x0u, 0x0u), n) : n;
    int top = nv2a_top_bit_64(m);
    int field = nv2a_clamp(unit + top + 1023, 0, 2047);
    uvec2 fraction = nv2a_u64_left(nv2a_u64_right(nv2a_u64_left(m, 63 - top), 64 - bits),
        53 - bits) & uvec2(0xffffffffu, 0xfffffu);
    uvec2 found = nv2a_u64_left(uvec2(uint(field), 0u), 52) | (field < 2047 ? fraction : uvec2(0x0u, 0x0u));
    if (m == uvec2(0x0u, 0x0u) || field == 0) {
        found = uvec2(0x0u, 0x0u);
    }
    return below != 0 && found != uvec2(0x0u, 0x0u) ? found | uvec2(0x0u, 0x80000000u) : found;
}

// The largest whole number that is not above a.
uvec2 nv2a_f64_floor(uvec2 a) {
    uvec2 whole = nv2a_f64_multiple(a, 0);
    if (nv2a_f64_less(a, whole) != 0) {
        whole = nv2a_f64_add(whole, uvec2(0x0u, 0xbff00000u));
    }
    return nv2a_f64_is_finite(a) != 0 ? whole : a;
}

// A finite double times 2^by, where neither is below double precision's normal numbers.
uvec2 nv2a_f64_scaled(uvec2 a, int by) {
    if (nv2a_f64_is_zero(a) != 0) {
        return a;
    }
    return nv2a_f64_round(a & uvec2(0x0u, 0x80000000u), nv2a_f64_unit(a) + by, nv2a_f64_significand(a));
}

// A double cut toward zero to a whole number, within -2^30 and 2^30; 0 for NaN.
int nv2a_int_of_f64(uvec2 a) {
    int bound = nv2a_f64_bound(a);
    int n = int(nv2a_u64_right(nv2a_f64_significand(a), nv2a_clamp(53 - bound, 0, 63)).x);
    if (bound > 30) {
        n = 1 << 30;
    }
    if (bound < 1 || nv2a_f64_is_nan(a) != 0) {
        n = 0;
    }
    return (a & uvec2(0x0u, 0x80000000u)) != uvec2(0x0u, 0x0u) ? -n : n;
}

// The same, but not above a.
int nv2a_floor_of_f64(uvec2 a) {
    return nv2a_int_of_f64(nv2a_f64_floor(a));
}

// The double that is nearest to a among singles, denormal ones too.
uvec2 nv2a_f64_to_single(uvec2 a) {
    if (!(nv2a_f64_is_finite(a) != 0) || nv2a_f64_is_zero(a) != 0) {
        return a;
    }
    int unit = nv2a_most(nv2a_f64_bound(a) - 24, -149);
    int dropped = unit - nv2a_f64_unit(a);
    uvec2 sign = a & uvec2(0x0u, 0x80000000u);
    uvec2 m = nv2a_f64_significand(a);
    if (dropped <= 0) {
        return a;
    }
    if (dropped > 54) {
        return sign;
    }
    uvec2 kept = nv2a_u64_right(m, dropped);
    uvec2 rest = nv2a_u64_subtract(m, nv2a_u64_left(kept, dropped));
    uvec2 middle = nv2a_u64_left(uvec2(0x1u, 0x0u), dropped - 1);
    if (nv2a_u64_less(middle, rest) || (rest == middle && (kept & uvec2(0x1u, 0x0u)) != uvec2(0x0u, 0x0u))) {
        kept = nv2a_u64_add(kept, uvec2(0x1u, 0x0u));
    }
    uvec2 found = nv2a_f64_round(sign, unit, kept);
    return nv2a_f64_bound(found) > 128 ? sign | uvec2(0x0u, 0x7ff00000u) : found;
}
