// The lighting unit's numbers, singles of 14 significant bits, and what a vertex becomes: docs/numbers.md, N2.5 to
// N2.7, N2.12 to N2.14, N2.25, N11.12.

// A single as the unit reads it, rounded to 14 bits.
uint nv2a_enter_lighting(uint x) {
    if (((x >> 10) & 255u) != 255u) {
        x += 512u;
    }
    x &= 0xfffffc00u;
    return nv2a_is_nan(x) != 0 ? 0x7fc00000u : x;
}

// a b cut to so many bits; an infinite product is positive, 0 times infinity is 0.
uint nv2a_unit_product(uint a, uint b, int bits) {
    if (nv2a_is_nan(a) != 0 || nv2a_is_nan(b) != 0) {
        return 0x7fc00000u;
    }
    if (nv2a_is_zero(a) != 0 || nv2a_is_zero(b) != 0) {
        return 0u;
    }
    if (nv2a_is_infinite(a) != 0 || nv2a_is_infinite(b) != 0) {
        return 0x7f800000u;
    }
    return nv2a_finite_product(a, b, bits);
}

uint nv2a_lighting_product(uint a, uint b) {
    return nv2a_unit_product(a, b, 14);
}

// The sum of four terms; an infinite sum is positive.
uint nv2a_lighting_total(uvec4 x, int guard) {
    for (int k = 0; k < 4; k++) {
        if (!(nv2a_is_finite(x[k]) != 0)) {
            return nv2a_program_sum(x) & 0x7fffffffu;
        }
    }
    return nv2a_finite_sum(x, 14, guard);
}

uint nv2a_lighting_sum(uint a, uint b, uint c) {
    uvec4 terms = uvec4(a, b, c, 0u);
    return nv2a_lighting_total(terms, 5);
}

// The product, then the sum: where a number is infinite or NaN.
uint nv2a_product_and_sum(uint a, uint b, uint c) {
    uvec4 terms = uvec4(nv2a_lighting_product(a, b), c, 0u, 0u);
    return nv2a_lighting_total(terms, 0);
}

// The 14 bits of a number that is not 0.
int nv2a_lighting_bits(uint x) {
    return int(((x & 0x7fffffu) | 0x800000u) >> 10);
}

uint nv2a_signed_packed(int sum, int e) {
    uint size = uint(sum < 0 ? -sum : sum);
    return nv2a_packed(sum < 0 ? 0x80000000u : 0u, uvec2(size, 0u), e, 14);
}

uint nv2a_lighting_multiply_add(uint a, uint b, uint c) {
    if (!(nv2a_is_finite(a) != 0) || !(nv2a_is_finite(b) != 0) || !(nv2a_is_finite(c) != 0)) {
        return nv2a_product_and_sum(a, b, c);
    }
    if (nv2a_is_zero(a) != 0 || nv2a_is_zero(b) != 0) {
        return nv2a_is_zero(c) != 0 ? 0u : c & 0xfffffc00u;
    }
    int ma = nv2a_lighting_bits(a);
    int mb = nv2a_lighting_bits(b);
    int mc = nv2a_is_zero(c) != 0 ? 0 : nv2a_lighting_bits(c);
    int place = int((a >> 23) & 255u) + int((b >> 23) & 255u) - 252;
    int lower = 0;
    if (mc != 0) {
        lower = int((c >> 23) & 255u) - 125 - place;
    }
    int product;
    int term;
    if (lower > 0) {
        product = lower < 14 ? (ma >> lower) * mb : 0;
        term = mc << 13;
    } else {
        product = ma * mb;
        term = lower > -14 ? mc >> -lower << 13 : 0;
    }
    if (((a ^ b) & 0x80000000u) != 0u) {
        product = -product;
    }
    if ((c & 0x80000000u) != 0u) {
        term = -term;
    }
    return nv2a_signed_packed(product + term, place - 28 + nv2a_most(lower, 0));
}

uint nv2a_lighting_add_product(uint a, uint b, uint c) {
    if (!(nv2a_is_finite(a) != 0) || !(nv2a_is_finite(b) != 0) || !(nv2a_is_finite(c) != 0)) {
        return nv2a_product_and_sum(a, b, c);
    }
    if (nv2a_is_zero(a) != 0 || nv2a_is_zero(b) != 0) {
        return nv2a_is_zero(c) != 0 ? 0u : c & 0xfffffc00u;
    }
    int product = nv2a_lighting_bits(a) * nv2a_lighting_bits(b);
    int e = int((a >> 23) & 255u) + int((b >> 23) & 255u) - 280;
    int top = e + nv2a_top_bit(uint(product)) + 1;
    int term = 0;
    if (!(nv2a_is_zero(c) != 0)) {
        int place = int((c >> 23) & 255u) - 126;
        top = nv2a_most(top, place);
        term = nv2a_lighting_bits(c) << 1 >> nv2a_least(top - place, 31);
    }
    product = product >> nv2a_least(top - 15 - e, 31);
    if (((a ^ b) & 0x80000000u) != 0u) {
        product = -product;
    }
    if ((c & 0x80000000u) != 0u) {
        term = -term;
    }
    return nv2a_signed_packed(product + term, top - 15);
}

uint nv2a_lighting_reciprocal(uint x) {
    uint m = uint(nv2a_lighting_bits(x));
    uint seed = 16384u / (129u + 2u * ((m >> 7) & 63u));
    uvec2 better = nv2a_u64_right(nv2a_u32_product((1u << 21) - seed * m, seed), 14);
    int e = int((x >> 23) & 255u) - 127;
    return nv2a_with_limits(nv2a_packed(x & 0x80000000u, better, -13 - e, 24), x);
}

const int nv2a_lighting_root_seeds[128] = int[128](127, 126, 125, 124, 123, 122, 121, 121, 120, 119, 118, 117, 117,
    116, 115, 114, 114, 113, 112, 112, 111, 110, 110, 109, 108, 108, 107, 107, 106, 105, 105, 104, 104, 103, 103,
    102, 102, 101, 101, 100, 100, 99, 99, 98, 98, 97, 97, 96, 96, 96, 95, 95, 94, 94, 94, 93, 93, 92, 92, 92, 91,
    91, 91, 90, 90, 89, 88, 88, 87, 86, 86, 85, 85, 84, 83, 83, 82, 82, 81, 81, 80, 80, 79, 79, 78, 78, 77, 77, 76,
    76, 76, 75, 75, 74, 74, 74, 73, 73, 72, 72, 72, 71, 71, 71, 70, 70, 70, 69, 69, 69, 68, 68, 68, 67, 67, 67, 67,
    66, 66, 66, 65, 65, 65, 65, 64, 64, 64, 64);

// 1/sqrt(|x|), of points' sizes.
uint nv2a_lighting_inverse_square_root(uint x) {
    int e = int((x >> 23) & 255u) - 127;
    int odd = e & 1;
    int seed = nv2a_lighting_root_seeds[int((x >> 17) & 63u) + 64 * odd];
    return nv2a_with_limits(nv2a_packed(0u, uvec2(uint(seed), 0u), -7 - (e >> 1), 24), x & 0x7fffffffu);
}

// x of the composite matrix, its w and the viewport's offset: a window coordinate.
uint nv2a_window_coordinate(uint x, uint w, uint offset) {
    uvec2 by = nv2a_f64_of_single(nv2a_reciprocal(w));
    uvec2 quotient = nv2a_f64_cut(nv2a_f64_multiply(nv2a_f64_of_single(x), by), 24);
    return nv2a_single_of_f64(nv2a_f64_add(quotient, nv2a_f64_of_single(offset)));
}

// A window coordinate in sixteenths of a pixel; extent: the surface's width, or its height.
int nv2a_snapped_coordinate(uint x, int extent) {
    int e = int((x >> 23) & 255u) - 127;
    int m = int((x & 0x7fffffu) | 0x800000u);
    int steps;
    if (nv2a_is_nan(x) != 0) {
        return -16777216;
    }
    if (e >= 22) {
        steps = 67108864;
    } else if (e >= 19) {
        steps = m << (e - 19);
    } else {
        steps = m >> nv2a_least(19 - e, 31);
    }
    return nv2a_clamp((x & 0x80000000u) != 0u ? -steps : steps, -16777216, 16 * (extent + 1048576));
}

// A colour from 0 to 1 as a byte.
int nv2a_color_to_byte(uint v) {
    int down = 140 - int((v >> 23) & 255u);
    int m = 255 * nv2a_lighting_bits(v);
    return down > 24 ? 0 : (m + (1 << (down - 1))) >> down;
}
