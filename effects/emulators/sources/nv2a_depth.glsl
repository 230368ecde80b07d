// Depths, their slopes, and the words of depth buffers: docs/numbers.md, section 5.

// a - b of depths to 24 bits; 0 below 2^-126.
uvec2 nv2a_depth_difference(uvec2 a, uvec2 b) {
    uvec2 found = nv2a_f64_cut(nv2a_f64_subtract(a, b), 24);
    return nv2a_u64_less(nv2a_f64_magnitude(found), uvec2(0x0u, 0x38100000u)) ? uvec2(0x0u, 0x0u) : found;
}

// A vertex's depth and two products, which are cut 29 bits below the largest's highest; 24 bits of the sum.
uvec2 nv2a_depth_sum(uvec2 middle, uvec2 first, uvec2 last) {
    uvec2 largest = nv2a_f64_larger(nv2a_f64_magnitude(first), nv2a_f64_magnitude(last));
    largest = nv2a_f64_larger(nv2a_f64_magnitude(middle), largest);
    if (nv2a_f64_is_zero(largest) != 0) {
        return uvec2(0x0u, 0x0u);
    }
    int unit = nv2a_f64_bound(largest) - 29;
    uvec2 sum = middle;
    for (int k = 0; k < 2; k++) {
        sum = nv2a_f64_add(sum, nv2a_f64_multiple(k == 0 ? first : last, unit));
    }
    return nv2a_f64_cut(sum, 24);
}

// 1/sum in 29 bits, of positive numbers: 14 bits, and a Newton step whose remainder is rounded to 2^-30.
uvec2 nv2a_reciprocal_29(uvec2 sum) {
    uvec2 one = uvec2(0x0u, 0x3ff00000u);
    uvec2 x = nv2a_f64_cut(sum, 29);
    uvec2 seed = nv2a_u64_left(nv2a_u64_right(nv2a_u64_add(nv2a_f64_divide(one, x), uvec2(0x0u, 0x40u)), 39), 39);
    uvec2 rest = nv2a_f64_subtract(one, nv2a_f64_multiply(x, seed));
    uvec2 nearest = nv2a_f64_multiple(rest, -30);
    uvec2 left = nv2a_f64_magnitude(nv2a_f64_subtract(rest, nearest));
    uvec2 step = nv2a_f64_less(rest, uvec2(0x0u, 0x0u)) != 0 ? uvec2(0x0u, 0xbe100000u) : uvec2(0x0u, 0x3e100000u);
    if (nv2a_f64_less(uvec2(0x0u, 0x3e000000u), left) != 0) {
        nearest = nv2a_f64_add(nearest, step);
    }
    return nv2a_f64_cut(nv2a_f64_add(seed, nv2a_f64_multiply(seed, nearest)), 29);
}

// The depth of a fragment from edge functions as doubles and three vertices' depths.
uvec2 nv2a_depth_of_edges(uvec2 n[3], uvec2 z[3]) {
    uvec2 e[3];
    uvec2 products[2];
    uvec2 total = uvec2(0x0u, 0x0u);
    for (int k = 0; k < 3; k++) {
        e[k] = nv2a_f64_cut(n[k], 24);
        total = nv2a_f64_add(total, e[k]);
    }
    uvec2 by = nv2a_reciprocal_29(total);
    int e0 = int(nv2a_u64_right(e[0], 52).x) & 2047;
    int e1 = int(nv2a_u64_right(e[1], 52).x) & 2047;
    int e2 = int(nv2a_u64_right(e[2], 52).x) & 2047;
    int base = e0 > e1 ? 0 : 1;
    int k = 0;
    if (e2 > e0 && e2 > e1) {
        base = 2;
    }
    for (int i = 0; i < 3; i++) {
        if (i != base) {
            uvec2 q = nv2a_f64_cut(nv2a_f64_product(e[i], by), 24);
            products[k] = nv2a_f64_product(q, nv2a_depth_difference(z[i], z[base]));
            k += 1;
        }
    }
    return nv2a_depth_sum(z[base], products[0], products[1]);
}

uvec2 nv2a_depth(ivec3 n, uvec3 z) {
    uvec2 edges[3];
    uvec2 depths[3];
    for (int k = 0; k < 3; k++) {
        edges[k] = nv2a_f64_of_int(n[k]);
        depths[k] = nv2a_f64_of_single(z[k]);
    }
    return nv2a_depth_of_edges(edges, depths);
}

// The depth of W buffering from weights and three vertices' w as doubles.
uvec2 nv2a_weighed_w(uvec2 q[2], uvec2 w[3]) {
    uvec2 products[2];
    for (int k = 0; k < 2; k++) {
        products[k] = nv2a_f64_product(q[k], nv2a_depth_difference(w[2 * k], w[1]));
    }
    return nv2a_depth_sum(w[1], products[0], products[1]);
}

uvec2 nv2a_depth_of_w(ivec3 n, uvec3 w) {
    uvec2 edges[3];
    uvec2 inverse[3];
    uvec2 depths[3];
    uvec2 q[2];
    for (int k = 0; k < 3; k++) {
        edges[k] = nv2a_f64_of_int(n[k]);
        depths[k] = nv2a_f64_of_single(w[k]);
        inverse[k] = nv2a_f64_divide(uvec2(0x0u, 0x3ff00000u), depths[k]);
    }
    nv2a_weights(edges, inverse, q);
    return nv2a_weighed_w(q, depths);
}

// What a polygon offset's factor adds: the larger of the slopes along x and y, times it.
uvec2 nv2a_polygon_offset_slope(ivec3 x, ivec3 y, uvec3 v, uint factor) {
    uvec2 d[2];
    uvec2 steepest = uvec2(0x0u, 0x0u);
    uvec2 area = nv2a_signed_area(x, y);
    if (area == uvec2(0u, 0u)) {
        return uvec2(0x0u, 0x0u);
    }
    for (int k = 0; k < 2; k++) {
        d[k] = nv2a_f64_subtract(nv2a_f64_of_single(v[k + 1]), nv2a_f64_of_single(v[0]));
    }
    for (int axis = 0; axis < 2; axis++) {
        uvec2 rise = uvec2(0x0u, 0x80000000u);
        for (int k = 0; k < 2; k++) {
            int reach = axis == 0 ? y[2 - k] - y[0] : x[2 - k] - x[0];
            rise = nv2a_f64_add(rise, nv2a_f64_multiply(d[k], nv2a_f64_of_int(k == 0 ? reach : -reach)));
        }
        rise = nv2a_f64_multiply(rise, uvec2(0x0u, 0x40300000u));
        uvec2 slope = nv2a_f64_magnitude(nv2a_f64_divide(rise, nv2a_f64_of_int64(area)));
        steepest = nv2a_f64_larger(steepest, slope);
    }
    return nv2a_f64_multiply(nv2a_f64_of_single(factor), steepest);
}

// The weights that the slope reads of one pixel: of vertices 0 and 2; their sum before it divides, uncut; whether
// there are any.
void nv2a_slope_weights(ivec3 x, ivec3 y, uvec2 factors[3], int px, int py, out uvec2 result[4]) {
    uvec2 n[3];
    uvec2 e[3];
    for (int k = 0; k < 3; k++) {
        n[k] = nv2a_f64_of_int64(nv2a_edge_function(x, y, k, px, py));
    }
    nv2a_weighed_edges(n, factors, e);
    uvec2 total = nv2a_weight_sum(e);
    uvec2 by = uvec2(0x0u, 0x3ff00000u);
    uvec2 sum = uvec2(0x0u, 0x80000000u);
    for (int k = 0; k < 3; k++) {
        sum = nv2a_f64_add(sum, nv2a_f64_multiply(n[k], factors[k]));
    }
    result[2] = sum;
    result[3] = nv2a_f64_less(uvec2(0x0u, 0x0u), total) != 0 ? uvec2(0x1u, 0x0u) : uvec2(0x0u, 0x0u);
    if (result[3] != uvec2(0x0u, 0x0u)) {
        by = nv2a_reciprocal_24(total);
    }
    result[0] = nv2a_f64_cut(nv2a_f64_product(e[0], by), 24);
    result[1] = nv2a_f64_cut(nv2a_f64_product(e[2], by), 24);
}

// Whether a pixel is drawn, also where a vertex's w is negative.
int nv2a_coverage_by_w(ivec3 x, ivec3 y, uvec3 w, int px, int py) {
    uvec2 zero = uvec2(0u, 0u);
    int turned = int(nv2a_i64_less(nv2a_signed_area(x, y), zero));
    int drawn = int(nv2a_signed_area(x, y) != zero);
    for (int k = 0; k < 3; k++) {
        int behind = int(w[k] > 0x80000000u);
        int swaps = int(turned != 0 != (behind != 0));
        int a = (k + (swaps != 0 ? 2 : 1)) % 3;
        int b = (k + (swaps != 0 ? 1 : 2)) % 3;
        uvec2 n = nv2a_edge_function(x, y, k, px, py);
        if (behind != 0) {
            n = nv2a_u64_subtract(zero, n);
        }
        int owned = int(y[b] < y[a] || (y[b] == y[a] && x[b] > x[a]));
        if (nv2a_i64_less(n, zero) || (n == zero && owned == 0)) {
            drawn = 0;
        }
    }
    return drawn;
}

// The slope of W buffering's polygon offset, of the first 2x2 block that the triangle draws in a box: left, top,
// right, bottom, from 0.
uvec2 nv2a_slope_of_w(ivec3 x, ivec3 y, uvec3 w, ivec4 box) {
    uvec2 depths[3];
    uvec2 inverse[3];
    uvec2 factors[3];
    uvec2 found = uvec2(0x0u, 0x0u);
    uvec2 nearest = uvec2(0x0u, 0x0u);
    int behind = 0;
    int first = 0;
    int any = 0;
    int tile_x = 0;
    int tile_y = 0;
    int closest = 0;
    for (int k = 0; k < 3; k++) {
        depths[k] = nv2a_f64_of_single(w[k]);
        inverse[k] = nv2a_f64_divide(uvec2(0x0u, 0x3ff00000u), depths[k]);
        if ((w[k] & 0x80000000u) != 0u && (w[k] & 0x7fffffffu) != 0u) {
            behind = 1;
        }
        if (y[k] < y[first]) {
            first = k;
        }
    }
    nv2a_weight_factors(inverse, factors);
    int at = nv2a_clamp(x[first] >> 4, box[0], box[2] - 1) >> 2;
    int top = behind != 0 ? box[1] : nv2a_most(box[1], nv2a_clamp(y[first] >> 4, box[1], box[3] - 1) >> 2 << 2);
    for (int py = top; py < box[3]; py++) {
        if (any != 0 && py >> 2 != tile_y) {
            break;
        }
        for (int px = box[0]; px < box[2]; px++) {
            int away = (px >> 2) - at;
            if (away < 0) {
                away = -away;
            }
            if ((any == 0 || away < closest || (away == closest && px >> 2 < tile_x)) && nv2a_coverage_by_w(x, y,
                w, px, py) != 0) {
                any = 1;
                tile_x = px >> 2;
                tile_y = py >> 2;
                closest = away;
            }
        }
    }
    if (any == 0) {
        return uvec2(0x0u, 0x0u);
    }
    int upper_only = 0;
    for (int block = 0; block < 4; block++) {
        int left = 4 * tile_x + 2 * (block & 1);
        int row = 4 * tile_y + (block & 2);
        int drawn = 0;
        int good = 1;
        uvec2 a[4];
        uvec2 b[4];
        uvec2 near = uvec2(0x0u, 0x0u);
        if (block >= 2 && upper_only != 0) {
            break;
        }
        for (int k = 0; k < 4; k++) {
            int px = left + (k & 1);
            int py = row + (k >> 1);
            if (px >= box[0] && px < box[2] && py >= top && py < box[3] && nv2a_coverage_by_w(x, y, w, px,
                py) != 0) {
                drawn = 1;
            }
        }
        if (drawn != 0) {
            if (row == 0 && y[first] < 0) {
                upper_only = 1;
            }
            for (int k = 0; k < 4; k++) {
                uvec2 of[4];
                nv2a_slope_weights(x, y, factors, left + (k & 1), row + (k >> 1), of);
                a[k] = of[0];
                b[k] = of[1];
                if (k == 0) {
                    near = of[2];
                }
                if (of[3] == uvec2(0x0u, 0x0u)) {
                    good = 0;
                }
            }
            if (good != 0 && !(nv2a_f64_less(near, nearest) != 0)) {
                nearest = near;
                found = uvec2(0x0u, 0x0u);
                for (int axis = 0; axis < 2; axis++) {
                    uvec2 along = uvec2(0x0u, 0x80000000u);
                    for (int k = 0; k < 2; k++) {
                        uvec2 step = nv2a_depth_difference(depths[2 * k], depths[1]);
                        uvec2 from = a[axis == 0 ? 2 : 0];
                        uvec2 to = a[axis == 0 ? 3 : 2];
                        if (k == 1) {
                            from = b[axis == 0 ? 0 : 1];
                            to = b[axis == 0 ? 1 : 3];
                        }
                        along = nv2a_f64_add(along, nv2a_f64_multiply(nv2a_f64_subtract(to, from), step));
                    }
                    found = nv2a_f64_larger(found, nv2a_f64_magnitude(along));
                }
                found = nv2a_f64_cut(found, 24);
            }
        }
    }
    return found;
}

// A depth within 0 and the largest word of a fixed format, as that word.
int nv2a_fixed_word(uvec2 depth, int largest) {
    if (!(nv2a_f64_less(uvec2(0x0u, 0x0u), depth) != 0)) {
        return 0;
    }
    return nv2a_least(nv2a_int_of_f64(depth), largest);
}

int nv2a_depth_word_fixed_16(uvec2 depth) {
    return nv2a_fixed_word(depth, 65535);
}

int nv2a_depth_word_fixed_24(uvec2 depth) {
    return nv2a_fixed_word(depth, 16777215);
}

// A depth as a float without a sign: so many bits of fraction, an exponent's bias, the largest word.
int nv2a_float_word(uvec2 depth, int fraction_bits, int bias, int largest) {
    int e = nv2a_f64_bound(depth) - 1 + bias;
    if (!(nv2a_f64_less(uvec2(0x0u, 0x0u), depth) != 0) || e < 1) {
        return 0;
    }
    if (e > largest >> fraction_bits) {
        return largest;
    }
    int fraction = int(nv2a_u64_right(nv2a_f64_significand(depth), 52 - fraction_bits).x) - (1 << fraction_bits);
    return nv2a_least((e << fraction_bits) + fraction, largest);
}

int nv2a_depth_word_float_16(uvec2 depth) {
    return nv2a_float_word(depth, 12, 7, 65535);
}

int nv2a_depth_word_float_24(uvec2 depth) {
    return nv2a_float_word(depth, 16, 127, 0xfeffff);
}
