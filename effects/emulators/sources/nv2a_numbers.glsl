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
    int n = 0;
    if (x >= 0x10000u) {
        x >>= 16;
        n += 16;
    }
    if (x >= 0x100u) {
        x >>= 8;
        n += 8;
    }
    if (x >= 0x10u) {
        x >>= 4;
        n += 4;
    }
    if (x >= 0x4u) {
        x >>= 2;
        n += 2;
    }
    return x >= 0x2u ? n + 1 : n;
}

// The same of 64 bits.
int nv2a_top_bit_64(uvec2 x) {
    uint high = nv2a_u64_right(x, 32).x;
    return high != 0u ? 32 + nv2a_top_bit(high) : nv2a_top_bit(x.x);
}

// The upper 64 of the 128 bits of a b; their last bit is set where the lower ones are not all 0.
uvec2 nv2a_upper_product(uvec2 a, uvec2 b) {
    uvec2 al = a & uvec2(0xffffffffu, 0x0u);
    uvec2 ah = nv2a_u64_right(a, 32);
    uvec2 bl = b & uvec2(0xffffffffu, 0x0u);
    uvec2 bh = nv2a_u64_right(b, 32);
    uvec2 low = nv2a_u64_multiply(al, bl);
    uvec2 first = nv2a_u64_multiply(ah, bl);
    uvec2 second = nv2a_u64_multiply(al, bh);
    uvec2 middle = nv2a_u64_add(nv2a_u64_add(nv2a_u64_right(low, 32), first & uvec2(0xffffffffu, 0x0u)),
        second & uvec2(0xffffffffu, 0x0u));
    uvec2 high = nv2a_u64_add(nv2a_u64_add(nv2a_u64_add(nv2a_u64_multiply(ah, bh), nv2a_u64_right(first, 32)),
        nv2a_u64_right(second, 32)), nv2a_u64_right(middle, 32));
    uvec2 rest = nv2a_u64_left(middle, 32) | (low & uvec2(0xffffffffu, 0x0u));
    return rest != uvec2(0x0u, 0x0u) ? high | uvec2(0x1u, 0x0u) : high;
}

// The double nearest to m 2^e with that sign bit. The last bit of m stands for all that m lacks.
uvec2 nv2a_f64_round(uvec2 sign, int e, uvec2 m) {
    if (m == uvec2(0x0u, 0x0u)) {
        return sign;
    }
    int up = 63 - nv2a_top_bit_64(m);
    m = nv2a_u64_left(m, up);
    int biased = e - up + 63 + 1023;
    if (biased >= 2047) {
        return sign | uvec2(0x0u, 0x7ff00000u);
    }
    int dropped = 11;
    if (biased < 1) {
        dropped = 12 - biased;
        biased = 0;
        if (dropped > 63) {
            return sign;
        }
    }
    uvec2 kept = nv2a_u64_right(m, dropped);
    uvec2 rest = nv2a_u64_left(m, 64 - dropped);
    if (nv2a_u64_less(uvec2(0x0u, 0x80000000u), rest) || (rest == uvec2(0x0u, 0x80000000u) && (kept & uvec2(0x1u,
        0x0u)) != uvec2(0x0u, 0x0u))) {
        kept = nv2a_u64_add(kept, uvec2(0x1u, 0x0u));
    }
    if (biased > 0) {
        kept = nv2a_u64_add(kept, nv2a_u64_left(uvec2(uint(biased - 1), 0u), 52));
    }
    return sign | kept;
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
    if (nv2a_f64_is_nan(a) != 0 || nv2a_f64_is_nan(b) != 0) {
        return uvec2(0x0u, 0x7ff80000u);
    }
    if (!(nv2a_f64_is_finite(a) != 0)) {
        if (!(nv2a_f64_is_finite(b) != 0) && a != b) {
            return uvec2(0x0u, 0x7ff80000u);
        }
        return a;
    }
    if (!(nv2a_f64_is_finite(b) != 0)) {
        return b;
    }
    if (nv2a_u64_less(nv2a_f64_magnitude(a), nv2a_f64_magnitude(b))) {
        uvec2 other = a;
        a = b;
        b = other;
    }
    uvec2 sign = a & uvec2(0x0u, 0x80000000u);
    uvec2 ma = nv2a_u64_left(nv2a_f64_significand(a), 10);
    uvec2 mb = nv2a_u64_left(nv2a_f64_significand(b), 10);
    int apart = nv2a_f64_unit(a) - nv2a_f64_unit(b);
    if (apart > 63) {
        mb = mb != uvec2(0x0u, 0x0u) ? uvec2(0x1u, 0x0u) : uvec2(0x0u, 0x0u);
    } else if (apart > 0) {
        uvec2 lost = nv2a_u64_left(mb, 64 - apart);
        mb = nv2a_u64_right(mb, apart);
        if (lost != uvec2(0x0u, 0x0u)) {
            mb = mb | uvec2(0x1u, 0x0u);
        }
    }
    int unit = nv2a_f64_unit(a) - 10;
    if (((a ^ b) & uvec2(0x0u, 0x80000000u)) == uvec2(0x0u, 0x0u)) {
        return nv2a_f64_round(sign, unit, nv2a_u64_add(ma, mb));
    }
    return ma == mb ? uvec2(0x0u, 0x0u) : nv2a_f64_round(sign, unit, nv2a_u64_subtract(ma, mb));
}

uvec2 nv2a_f64_subtract(uvec2 a, uvec2 b) {
    return nv2a_f64_add(a, nv2a_f64_negated(b));
}

uvec2 nv2a_f64_multiply(uvec2 a, uvec2 b) {
    uvec2 sign = (a ^ b) & uvec2(0x0u, 0x80000000u);
    if (nv2a_f64_is_nan(a) != 0 || nv2a_f64_is_nan(b) != 0) {
        return uvec2(0x0u, 0x7ff80000u);
    }
    if (!(nv2a_f64_is_finite(a) != 0) || !(nv2a_f64_is_finite(b) != 0)) {
        if (nv2a_f64_is_zero(a) != 0 || nv2a_f64_is_zero(b) != 0) {
            return uvec2(0x0u, 0x7ff80000u);
        }
        return sign | uvec2(0x0u, 0x7ff00000u);
    }
    uvec2 ma = nv2a_f64_significand(a);
    uvec2 mb = nv2a_f64_significand(b);
    if (ma == uvec2(0x0u, 0x0u) || mb == uvec2(0x0u, 0x0u)) {
        return sign;
    }
    int up = 63 - nv2a_top_bit_64(ma);
    int over = 63 - nv2a_top_bit_64(mb);
    uvec2 m = nv2a_upper_product(nv2a_u64_left(ma, up), nv2a_u64_left(mb, over));
    return nv2a_f64_round(sign, nv2a_f64_unit(a) - up + nv2a_f64_unit(b) - over + 64, m);
}

uvec2 nv2a_f64_divide(uvec2 a, uvec2 b) {
    uvec2 sign = (a ^ b) & uvec2(0x0u, 0x80000000u);
    if (nv2a_f64_is_nan(a) != 0 || nv2a_f64_is_nan(b) != 0) {
        return uvec2(0x0u, 0x7ff80000u);
    }
    if (!(nv2a_f64_is_finite(a) != 0)) {
        return nv2a_f64_is_finite(b) != 0 ? sign | uvec2(0x0u, 0x7ff00000u) : uvec2(0x0u, 0x7ff80000u);
    }
    if (!(nv2a_f64_is_finite(b) != 0)) {
        return sign;
    }
    uvec2 rest = nv2a_f64_significand(a);
    uvec2 divisor = nv2a_f64_significand(b);
    if (divisor == uvec2(0x0u, 0x0u)) {
        return rest == uvec2(0x0u, 0x0u) ? uvec2(0x0u, 0x7ff80000u) : sign | uvec2(0x0u, 0x7ff00000u);
    }
    if (rest == uvec2(0x0u, 0x0u)) {
        return sign;
    }
    int up = 52 - nv2a_top_bit_64(rest);
    int over = 52 - nv2a_top_bit_64(divisor);
    rest = nv2a_u64_left(rest, up);
    divisor = nv2a_u64_left(divisor, over);
    uvec2 quotient = uvec2(0x0u, 0x0u);
    for (int k = 0; k < 56; k++) {
        quotient = nv2a_u64_left(quotient, 1);
        if (!nv2a_u64_less(rest, divisor)) {
            rest = nv2a_u64_subtract(rest, divisor);
            quotient = quotient | uvec2(0x1u, 0x0u);
        }
        rest = nv2a_u64_left(rest, 1);
    }
    if (rest != uvec2(0x0u, 0x0u)) {
        quotient = quotient | uvec2(0x1u, 0x0u);
    }
    return nv2a_f64_round(sign, nv2a_f64_unit(a) - up - nv2a_f64_unit(b) + over - 55, quotient);
}

// a < b; false where one is NaN.
int nv2a_f64_less(uvec2 a, uvec2 b) {
    if (nv2a_f64_is_nan(a) != 0 || nv2a_f64_is_nan(b) != 0) {
        return 0;
    }
    uvec2 ma = nv2a_f64_magnitude(a);
    uvec2 mb = nv2a_f64_magnitude(b);
    int negative_a = int(ma != a && ma != uvec2(0x0u, 0x0u));
    int negative_b = int(mb != b && mb != uvec2(0x0u, 0x0u));
    if (negative_a != negative_b) {
        return negative_a;
    }
    return int(negative_a != 0 ? nv2a_u64_less(mb, ma) : nv2a_u64_less(ma, mb));
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
    if (nv2a_i64_less(n, uvec2(0u, 0u))) {
        return nv2a_f64_round(uvec2(0x0u, 0x80000000u), 0, nv2a_u64_subtract(uvec2(0x0u, 0x0u), m));
    }
    return nv2a_f64_round(uvec2(0x0u, 0x0u), 0, m);
}

// The double that a single is.
uvec2 nv2a_f64_of_single(uint x) {
    uvec2 sign = nv2a_u64_left(uvec2(x & 0x80000000u, 0u), 32);
    uint field = (x >> 23) & 255u;
    uint fraction = x & 0x7fffffu;
    if (field == 255u) {
        return fraction != 0u ? uvec2(0x0u, 0x7ff80000u) : sign | uvec2(0x0u, 0x7ff00000u);
    }
    if (field == 0u) {
        return nv2a_f64_round(sign, -149, uvec2(fraction, 0u));
    }
    return sign | nv2a_u64_left(uvec2(field + 896u, 0u), 52) | nv2a_u64_left(uvec2(fraction, 0u), 29);
}

// The single that a double is, cut toward zero; 0 where it is below 2^-126, the largest where it is above.
uint nv2a_single_of_f64(uvec2 a) {
    uint sign = nv2a_u64_right(a, 32).x & 0x80000000u;
    if (nv2a_f64_is_nan(a) != 0) {
        return 0x7fc00000u;
    }
    if (!(nv2a_f64_is_finite(a) != 0)) {
        return sign | 0x7f800000u;
    }
    int field = (int(nv2a_u64_right(a, 52).x) & 2047) - 896;
    if (field < 1) {
        return sign;
    }
    if (field > 254) {
        return sign | 0x7f7fffffu;
    }
    return sign | (uint(field) << 23) | (nv2a_u64_right(a, 29).x & 0x7fffffu);
}

// A double cut toward zero to so many significant bits, 1 to 53.
uvec2 nv2a_f64_cut(uvec2 a, int bits) {
    int dropped = 53 - bits;
    return nv2a_u64_left(nv2a_u64_right(a, dropped), dropped);
}

// A finite double cut toward zero to a multiple of 2^unit; it keeps its sign.
uvec2 nv2a_f64_multiple(uvec2 a, int unit) {
    int dropped = unit - nv2a_f64_unit(a);
    if (dropped <= 0) {
        return a;
    }
    if (dropped > 52) {
        return a & uvec2(0x0u, 0x80000000u);
    }
    return nv2a_u64_left(nv2a_u64_right(a, dropped), dropped);
}

// The largest whole number that is not above a.
uvec2 nv2a_f64_floor(uvec2 a) {
    if (!(nv2a_f64_is_finite(a) != 0)) {
        return a;
    }
    uvec2 whole = nv2a_f64_multiple(a, 0);
    if (nv2a_f64_less(a, whole) != 0) {
        return nv2a_f64_add(whole, uvec2(0x0u, 0xbff00000u));
    }
    return whole;
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
    if (nv2a_f64_is_nan(a) != 0) {
        return 0;
    }
    int n;
    int bound = nv2a_f64_bound(a);
    if (bound > 30) {
        n = 1 << 30;
    } else if (bound < 1) {
        n = 0;
    } else {
        n = int(nv2a_u64_right(nv2a_f64_significand(a), 53 - bound).x);
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
