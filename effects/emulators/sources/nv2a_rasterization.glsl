// Coverage, weights, iterated colours and coordinates: docs/numbers.md, sections 3, 4 and 6.
//
// x and y are sixteenths of a pixel, n three edge functions, inverse_w the vertices' 1/w.

// Twice the signed area, in squares of a sixteenth of a pixel.
uvec2 nv2a_signed_area(ivec3 x, ivec3 y) {
    uvec2 x1 = nv2a_i64_of_int(x[1] - x[0]);
    uvec2 x2 = nv2a_i64_of_int(x[2] - x[0]);
    uvec2 y1 = nv2a_i64_of_int(y[1] - y[0]);
    uvec2 y2 = nv2a_i64_of_int(y[2] - y[0]);
    return nv2a_u64_subtract(nv2a_u64_multiply(x1, y2), nv2a_u64_multiply(x2, y1));
}

// The edge function of vertex k, from 0, at the middle of a pixel: 0 on the opposite edge, the area at the vertex.
uvec2 nv2a_edge_function(ivec3 x, ivec3 y, int k, int px, int py) {
    int a = k == 2 ? 0 : k + 1;
    int b = k == 0 ? 2 : k - 1;
    uvec2 dx = nv2a_i64_of_int(16 * px + 8 - x[a]);
    uvec2 dy = nv2a_i64_of_int(16 * py + 8 - y[a]);
    uvec2 along = nv2a_u64_subtract(nv2a_u64_multiply(nv2a_i64_of_int(x[b] - x[a]), dy),
        nv2a_u64_multiply(nv2a_i64_of_int(y[b] - y[a]), dx));
    return nv2a_i64_less(nv2a_signed_area(x, y), uvec2(0u, 0u)) ? nv2a_u64_subtract(uvec2(0u, 0u), along) : along;
}

// Whether the pixel is drawn: on an edge, where it is a left or a top one.
int nv2a_coverage(ivec3 x, ivec3 y, int px, int py) {
    uvec2 zero = uvec2(0u, 0u);
    int turned = int(nv2a_i64_less(nv2a_signed_area(x, y), zero));
    int drawn = int(nv2a_signed_area(x, y) != zero);
    for (int k = 0; k < 3; k++) {
        int a = (k + (turned != 0 ? 2 : 1)) % 3;
        int b = (k + (turned != 0 ? 1 : 2)) % 3;
        uvec2 n = nv2a_edge_function(x, y, k, px, py);
        int owned = int(y[b] < y[a] || (y[b] == y[a] && x[b] > x[a]));
        if (nv2a_i64_less(n, zero) || (n == zero && owned == 0)) {
            drawn = 0;
        }
    }
    return drawn;
}

// 1/s of a positive s of 24 significant bits.
uvec2 nv2a_reciprocal_24(uvec2 s) {
    uvec2 significand = nv2a_f64_significand(s);
    int up = 52 - nv2a_top_bit_64(significand);
    uint m = nv2a_u64_right(nv2a_u64_left(significand, up), 29).x;
    uint near = (m + 256u) >> 9;
    uint x = 67108864u / near;
    if (512u * (67108864u - x * near) >= 255u * near) {
        x += 1u;
    }
    int rest = int(0u - m * x);
    int half_up = int((uint(rest < 0 ? -rest : rest) + 1023u) >> 11);
    uvec2 best = nv2a_u32_product(x, uint(16777216 + (rest < 0 ? -half_up : half_up)));
    return nv2a_f64_cut(nv2a_f64_round(uvec2(0x0u, 0x0u), -35 - nv2a_f64_bound(s), best), 24);
}

uvec2 nv2a_weight_reciprocal(uint s) {
    return nv2a_reciprocal_24(nv2a_f64_of_single(s));
}

// 1/x of any sign: of 0 infinity, of infinity 0; the sign of what is not at least 0 changes.
uvec2 nv2a_reciprocal_of_sum(uvec2 x) {
    uvec2 size = nv2a_f64_magnitude(x);
    uvec2 found;
    if (nv2a_f64_is_nan(x) != 0) {
        return uvec2(0x0u, 0x7ff80000u);
    }
    if (size == uvec2(0x0u, 0x0u)) {
        found = uvec2(0x0u, 0x7ff00000u);
    } else if (!(nv2a_f64_is_finite(x) != 0)) {
        found = uvec2(0x0u, 0x0u);
    } else {
        found = nv2a_reciprocal_24(size);
    }
    return nv2a_f64_less(x, uvec2(0x0u, 0x0u)) != 0 ? nv2a_f64_subtract(uvec2(0x0u, 0x0u), found) : found;
}

// What each vertex's edge function is multiplied with: the product of the other two w, with the sign of its own; one
// where the three are equal.
void nv2a_weight_factors(uvec2 inverse_w[3], out uvec2 result[3]) {
    int equal = int(inverse_w[0] == inverse_w[1] && inverse_w[1] == inverse_w[2]);
    uvec2 w[3];
    for (int k = 0; k < 3; k++) {
        w[k] = uvec2(0x0u, 0x3ff00000u);
        if (!(equal != 0)) {
            w[k] = nv2a_f64_to_single(nv2a_f64_divide(uvec2(0x0u, 0x3ff00000u), nv2a_f64_magnitude(inverse_w[k])));
            if (nv2a_u64_less(uvec2(0xe0000000u, 0x47efffffu), w[k])) {
                w[k] = uvec2(0xe0000000u, 0x47efffffu);
            }
        }
    }
    for (int k = 0; k < 3; k++) {
        uvec2 others = nv2a_f64_cut(nv2a_f64_product(w[k == 0 ? 1 : 0], w[k == 2 ? 1 : 2]), 24);
        if (nv2a_u64_less(others, uvec2(0x0u, 0x2d300000u))) {
            others = uvec2(0x0u, 0x2d300000u);
        }
        result[k] = equal != 0 ? uvec2(0x0u, 0x3ff00000u) : others | (inverse_w[k] & uvec2(0x0u, 0x80000000u));
    }
}

// The edge functions by their factors, of 24 bits.
void nv2a_weighed_edges(uvec2 n[3], uvec2 factors[3], out uvec2 e[3]) {
    for (int k = 0; k < 3; k++) {
        e[k] = nv2a_f64_cut(nv2a_f64_product(nv2a_f64_cut(n[k], 24), factors[k]), 24);
    }
}

// Their sum, of which each loses what is more than a bit below the 24 of the largest.
uvec2 nv2a_weight_sum(uvec2 e[3]) {
    int bound = -255;
    for (int k = 0; k < 3; k++) {
        if (!(nv2a_f64_is_zero(e[k]) != 0)) {
            bound = nv2a_most(bound, nv2a_f64_bound(e[k]));
        }
    }
    uvec2 total = uvec2(0u, 0u);
    for (int k = 0; k < 3; k++) {
        total = nv2a_u64_add(total, nv2a_f64_in_units(e[k], bound - 25));
    }
    return nv2a_f64_of_units(total, bound - 25, 24);
}

// What two weights leave of one.
uvec2 nv2a_rest_of(uvec2 a, uvec2 b) {
    uvec2 taken = nv2a_u64_add(nv2a_f64_in_units(a, -25), nv2a_f64_in_units(b, -25));
    return nv2a_f64_of_units(nv2a_u64_subtract(uvec2(33554432u, 0u), taken), -25, 24);
}

// How many of 1/2 and 1/4 a weight reaches.
int nv2a_weight_class(uvec2 q) {
    if ((q & uvec2(0x0u, 0x80000000u)) != uvec2(0x0u, 0x0u) || nv2a_u64_less(q, uvec2(0x0u, 0x3fd00000u))) {
        return 0;
    }
    return nv2a_u64_less(q, uvec2(0x0u, 0x3fe00000u)) ? 1 : 2;
}

// The weights of vertices 0 and 2, of edge functions and 1/w as doubles.
void nv2a_weights(uvec2 n[3], uvec2 inverse_w[3], out uvec2 result[2]) {
    uvec2 factors[3];
    uvec2 e[3];
    uvec2 q[3];
    nv2a_weight_factors(inverse_w, factors);
    nv2a_weighed_edges(n, factors, e);
    uvec2 total = nv2a_weight_sum(e);
    if (nv2a_f64_is_zero(total) != 0) {
        total = uvec2(0x0u, 0x3ff00000u);
    }
    uvec2 by = nv2a_reciprocal_of_sum(total);
    for (int k = 0; k < 3; k++) {
        q[k] = nv2a_f64_cut(nv2a_f64_product(e[k], by), 24);
    }
    int c0 = nv2a_weight_class(q[0]);
    int c1 = nv2a_weight_class(q[1]);
    int c2 = nv2a_weight_class(q[2]);
    result[0] = q[0];
    result[1] = q[2];
    if (c0 >= c1 && c0 > c2) {
        result[0] = nv2a_rest_of(q[1], q[2]);
    }
    if (c2 >= c0 && (c2 > c1 || (c2 == c1 && c0 == c1))) {
        result[1] = nv2a_rest_of(q[0], q[1]);
    }
}

void nv2a_iteration_weights(ivec3 n, uvec3 inverse_w, out uvec2 result[2]) {
    uvec2 edges[3];
    uvec2 inverse[3];
    for (int k = 0; k < 3; k++) {
        edges[k] = nv2a_f64_of_int(n[k]);
        inverse[k] = nv2a_f64_of_single(inverse_w[k]);
    }
    nv2a_weights(edges, inverse, result);
}

// A colour's component of three vertices, by weights of 8 bits.
int nv2a_weighed_color(uvec2 q[2], ivec3 c) {
    int w0 = nv2a_clamp(nv2a_int_of_f64(nv2a_f64_scaled(q[0], 8)), -65536, 65536);
    int w2 = nv2a_clamp(nv2a_int_of_f64(nv2a_f64_scaled(q[1], 8)), -65536, 65536);
    int found = (w0 * c[0] + (256 - w0 - w2) * c[1] + w2 * c[2] + 128) >> 8;
    int least = nv2a_least(nv2a_least(c[0], c[1]), c[2]);
    int most = nv2a_most(nv2a_most(c[0], c[1]), c[2]);
    return nv2a_clamp(found, least, most);
}

int nv2a_iterated_color(ivec3 n, uvec3 inverse_w, ivec3 c) {
    uvec2 q[2];
    nv2a_iteration_weights(n, inverse_w, q);
    return nv2a_weighed_color(q, c);
}

// The place of the highest bit; that of 0 is below all others.
int nv2a_highest(uvec2 a) {
    return nv2a_f64_is_zero(a) != 0 ? -1048576 : nv2a_f64_bound(a) - 1;
}

// The sum of three products, each cut to 2^-23 of the largest product of two factors' highest bits; 24 bits of it.
uvec2 nv2a_product_sum(uvec2 a[3], uvec2 b[3]) {
    int e = -100;
    for (int k = 0; k < 3; k++) {
        if (!(nv2a_f64_is_finite(a[k]) != 0) || !(nv2a_f64_is_finite(b[k]) != 0)) {
            return uvec2(0x0u, 0x7ff80000u);
        }
        e = nv2a_most(e, nv2a_highest(a[k]) + nv2a_highest(b[k]));
    }
    uvec2 total = uvec2(0u, 0u);
    for (int k = 0; k < 3; k++) {
        total = nv2a_u64_add(total, nv2a_f64_in_units(nv2a_f64_product(a[k], b[k]), e - 23));
    }
    return nv2a_f64_of_units(total, e - 23, 24);
}

// a - b of vertices' coordinates, both cut a bit below the 24 of the larger; 24 bits of it.
uvec2 nv2a_coordinate_difference(uvec2 a, uvec2 b) {
    if (!(nv2a_f64_is_finite(a) != 0) || !(nv2a_f64_is_finite(b) != 0)) {
        return nv2a_f64_subtract(a, b);
    }
    int bound = -99;
    if (!(nv2a_f64_is_zero(a) != 0)) {
        bound = nv2a_most(bound, nv2a_f64_bound(a));
    }
    if (!(nv2a_f64_is_zero(b) != 0)) {
        bound = nv2a_most(bound, nv2a_f64_bound(b));
    }
    uvec2 steps = nv2a_u64_subtract(nv2a_f64_in_units(a, bound - 25), nv2a_f64_in_units(b, bound - 25));
    return nv2a_f64_of_units(steps, bound - 25, 24);
}

// A texture coordinate of three vertices' doubles, by the weights of vertices 0 and 2.
uvec2 nv2a_weighed_coordinate(uvec2 q[2], uvec2 v[3]) {
    uvec2 a[3] = uvec2[3](v[1], q[0], q[1]);
    uvec2 b[3] = uvec2[3](uvec2(0x0u, 0x3ff00000u), uvec2(0x0u, 0x0u), uvec2(0x0u, 0x0u));
    b[1] = nv2a_coordinate_difference(v[0], v[1]);
    b[2] = nv2a_coordinate_difference(v[2], v[1]);
    return nv2a_product_sum(a, b);
}

uvec2 nv2a_iterated_coordinate(ivec3 n, uvec3 inverse_w, uvec3 v) {
    uvec2 q[2];
    uvec2 values[3];
    nv2a_iteration_weights(n, inverse_w, q);
    for (int k = 0; k < 3; k++) {
        values[k] = nv2a_f64_of_single(v[k]);
    }
    return nv2a_weighed_coordinate(q, values);
}

// s, t or r over q, for a texture's access. A q of 0 counts as 2^-64.
uvec2 nv2a_divided_coordinate(uint c, uint q) {
    uvec2 by = nv2a_f64_of_single(q);
    if (nv2a_f64_is_zero(by) != 0) {
        by = uvec2(0x0u, 0x3bf00000u);
    }
    return nv2a_f64_cut(nv2a_f64_multiply(nv2a_f64_of_single(c), nv2a_reciprocal_of_sum(by)), 24);
}
