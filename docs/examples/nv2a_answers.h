/* Answers to open questions of emulators, made of the functions that `fixedpipe golden export DIR --code c99` writes:
 * docs/open-questions.md explains them, with the captures of a real NV2A that show each. All numbers but those of the
 * last two functions are single-precision numbers' bits, as the lighting unit holds them. MIT licence. */
#ifndef NV2A_ANSWERS_H
#define NV2A_ANSWERS_H

#include "nv2a_lighting_unit.h"

/* a + b of the lighting unit, without the bits below the larger one's last. */
static inline uint32_t nv2a_light_sum(uint32_t a, uint32_t b) {
    uint32_t terms[4] = {a, b, 0u, 0u};
    return nv2a_lighting_total(terms, 0);
}

/* Whether a number is below zero. */
static inline int nv2a_is_below_zero(uint32_t x) {
    return (x & 0x80000000u) != 0u && !nv2a_is_zero(x) && !nv2a_is_nan(x);
}

/* 1 where a light of this range reaches a vertex at this distance: at the range itself too. */
static inline int nv2a_light_reaches(uint32_t range, uint32_t distance) {
    return !nv2a_is_below_zero(nv2a_light_sum(range, distance ^ 0x80000000u));
}

/* A spotlight's strength: S times (x + a) / (b x + c), x the cone's axis times the direction, at most 1. */
static inline uint32_t nv2a_light_cone(uint32_t strength, uint32_t x, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t above = nv2a_light_sum(x, a), below = nv2a_lighting_multiply_add(b, x, c);
    if (nv2a_is_below_zero(x) || nv2a_is_below_zero(above) || nv2a_is_zero(above)) return 0u;
    return nv2a_lighting_product(nv2a_lighting_product(strength, above), nv2a_lighting_reciprocal(below));
}

/* The highlight by a half vector that the program gave: x is the normal times it. */
static inline uint32_t nv2a_light_highlight_of_half(uint32_t strength, uint32_t x, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t above = nv2a_light_sum(x, a), below = nv2a_lighting_multiply_add(x, b, c);
    if (nv2a_is_below_zero(above)) return 0u;
    return nv2a_lighting_product(nv2a_lighting_product(strength, above), nv2a_lighting_reciprocal(below));
}

/* The highlight by the unit's own half vector h: x is the normal times h, square is h times h. */
static inline uint32_t nv2a_light_highlight(uint32_t strength, uint32_t x, uint32_t square, uint32_t a, uint32_t b,
                                            uint32_t c) {
    uint32_t xx = nv2a_lighting_product(x, x);
    uint32_t above = nv2a_lighting_multiply_add(square, a, xx);
    uint32_t below = nv2a_lighting_multiply_add(square, c, nv2a_lighting_product(xx, b));
    if (nv2a_is_below_zero(x) || nv2a_is_below_zero(above)) return 0u;
    return nv2a_lighting_product(nv2a_lighting_product(strength, above), nv2a_lighting_reciprocal(below));
}

/* 1 where a point covers a sample that lies (dx, dy) right of and below its middle, both in sixteenths of a pixel.
 * The point's size is in eighths of a pixel and positive. */
static inline int nv2a_point_covers(int dx, int dy, int size) {
    int whole = (2 * size & (2 * size - 1)) == 0; /* a power of two: then the right and lower sides are outside */
    int most = whole ? size - 1 : size;
    return -size <= dx && dx <= most && -size <= dy && dy <= most;
}

/* The vertex whose colour a flat primitive takes, as a number within it: triangle k of a strip, a fan or a polygon,
 * quad k of a strip. Kinds are OpenGL's: 4 to 9, TRIANGLES to POLYGON. first: SET_FLAT_SHADE_OP is 1. */
static inline int nv2a_flat_vertex(int kind, int k, int first) {
    if (kind == 9) return 0;
    if (kind == 8) return 2 * k + 3;
    if (kind == 7) return 4 * k + 3;
    if (kind == 6) return first ? k + 1 : k + 2;
    if (kind == 5) return first ? k : k + 2;
    return first ? 3 * k : 3 * k + 2;
}

#endif
