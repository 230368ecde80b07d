// Answers to open questions of emulators, made of the functions that `fixedpipe golden export DIR --code c99` writes:
// docs/open-questions.md explains them, with the captures of a real NV2A that show each. All numbers but those of the
// last two functions are single-precision numbers' bits, as the lighting unit holds them. MIT licence.

// a + b of the lighting unit, without the bits below the larger one's last.
uint nv2a_light_sum(uint a, uint b) {
    uvec4 terms = uvec4(a, b, 0u, 0u);
    return nv2a_lighting_total(terms, 0);
}

// Whether a number is below zero.
int nv2a_is_below_zero(uint x) {
    return int((x & 0x80000000u) != 0u && !(nv2a_is_zero(x) != 0) && !(nv2a_is_nan(x) != 0));
}

// 1 where a light of this range reaches a vertex at this distance: at the range itself too.
int nv2a_light_reaches(uint range, uint distance) {
    return int(!(nv2a_is_below_zero(nv2a_light_sum(range, distance ^ 0x80000000u)) != 0));
}

// A spotlight's strength: S times (x + a) / (b x + c), x the cone's axis times the direction, at most 1.
uint nv2a_light_cone(uint strength, uint x, uint a, uint b, uint c) {
    uint above = nv2a_light_sum(x, a);
    uint below = nv2a_lighting_multiply_add(b, x, c);
    if (nv2a_is_below_zero(x) != 0 || nv2a_is_below_zero(above) != 0 || nv2a_is_zero(above) != 0) {
        return 0u;
    }
    return nv2a_lighting_product(nv2a_lighting_product(strength, above), nv2a_lighting_reciprocal(below));
}

// The highlight by a half vector that the program gave: x is the normal times it.
uint nv2a_light_highlight_of_half(uint strength, uint x, uint a, uint b, uint c) {
    uint above = nv2a_light_sum(x, a);
    uint below = nv2a_lighting_multiply_add(x, b, c);
    if (nv2a_is_below_zero(above) != 0) {
        return 0u;
    }
    return nv2a_lighting_product(nv2a_lighting_product(strength, above), nv2a_lighting_reciprocal(below));
}

// The highlight by the unit's own half vector h: x is the normal times h, square is h times h.
uint nv2a_light_highlight(uint strength, uint x, uint square, uint a, uint b, uint c) {
    uint xx = nv2a_lighting_product(x, x);
    uint above = nv2a_lighting_multiply_add(square, a, xx);
    uint below = nv2a_lighting_multiply_add(square, c, nv2a_lighting_product(xx, b));
    if (nv2a_is_below_zero(x) != 0 || nv2a_is_below_zero(above) != 0) {
        return 0u;
    }
    return nv2a_lighting_product(nv2a_lighting_product(strength, above), nv2a_lighting_reciprocal(below));
}

// 1 where a point covers a sample that lies (dx, dy) right of and below its middle, both in sixteenths of a pixel.
// The point's size is in eighths of a pixel and positive.
int nv2a_point_covers(int dx, int dy, int size) {
    int whole = int(((2 * size) & (2 * size - 1)) == 0);
    int most = whole != 0 ? size - 1 : size;
    return int(-size <= dx && dx <= most && -size <= dy && dy <= most);
}

// The vertex whose colour a flat primitive takes, as a number within it: triangle k of a strip, a fan or a polygon,
// quad k of a strip. Kinds are OpenGL's: 4 to 9, TRIANGLES to POLYGON. first: SET_FLAT_SHADE_OP is 1.
int nv2a_flat_vertex(int kind, int k, int first) {
    if (kind == 9) {
        return 0;
    }
    if (kind == 8) {
        return 2 * k + 3;
    }
    if (kind == 7) {
        return 4 * k + 3;
    }
    if (kind == 6) {
        return first != 0 ? k + 1 : k + 2;
    }
    if (kind == 5) {
        return first != 0 ? k : k + 2;
    }
    return first != 0 ? 3 * k : 3 * k + 2;
}
