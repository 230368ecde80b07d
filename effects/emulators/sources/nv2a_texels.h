/* Texels as memory holds them, as four bytes of a register: docs/numbers.md, N6.6 and N7.1 to N7.4. */
#ifndef NV2A_TEXELS_H
#define NV2A_TEXELS_H

#include "nv2a_numbers.h"

/* A component of 1 to 8 bits as a byte: its bits repeated. */
static inline int nv2a_widened(int v, int bits) {
    return (v << (8 - bits)) | (v >> (2 * bits - 8));
}

static inline void nv2a_rgba(int red, int green, int blue, int alpha, int result[4]) {
    result[0] = red;
    result[1] = green;
    result[2] = blue;
    result[3] = alpha;
}

/* Rules texel-...: w is a word of 16 bits, or of 8. */
static inline void nv2a_texel_r5g6b5(int w, int result[4]) {
    nv2a_rgba(nv2a_widened(w >> 11 & 31, 5), nv2a_widened(w >> 5 & 63, 6), nv2a_widened(w & 31, 5), 255, result);
}

static inline void nv2a_texel_x1r5g5b5(int w, int result[4]) {
    nv2a_rgba(nv2a_widened(w >> 10 & 31, 5), nv2a_widened(w >> 5 & 31, 5), nv2a_widened(w & 31, 5), 255, result);
}

static inline void nv2a_texel_a1r5g5b5(int w, int result[4]) {
    nv2a_texel_x1r5g5b5(w, result);
    result[3] = 255 * (w >> 15 & 1);
}

static inline void nv2a_texel_a4r4g4b4(int w, int result[4]) {
    nv2a_rgba(17 * (w >> 8 & 15), 17 * (w >> 4 & 15), 17 * (w & 15), 17 * (w >> 12 & 15), result);
}

static inline void nv2a_texel_r6g5b5(int w, int result[4]) {
    nv2a_rgba(nv2a_widened(w >> 10 & 63, 6), nv2a_widened(w >> 5 & 31, 5), nv2a_widened(w & 31, 5), 255, result);
}

static inline void nv2a_texel_g8b8(int w, int result[4]) {
    nv2a_rgba(w & 255, w >> 8 & 255, w & 255, w >> 8 & 255, result);
}

static inline void nv2a_texel_r8b8(int w, int result[4]) {
    nv2a_rgba(w >> 8 & 255, w & 255, w & 255, w >> 8 & 255, result);
}

static inline void nv2a_texel_a8y8(int w, int result[4]) {
    nv2a_rgba(w & 255, w & 255, w & 255, w >> 8 & 255, result);
}

static inline void nv2a_texel_ay8(int w, int result[4]) {
    nv2a_rgba(w & 255, w & 255, w & 255, w & 255, result);
}

static inline void nv2a_texel_a8(int w, int result[4]) {
    nv2a_rgba(255, 255, 255, w & 255, result);
}

static inline void nv2a_texel_y16(int w, int result[4]) {
    nv2a_rgba(255, w >> 8 & 255, w & 255, 255, result);
}

/* A byte of a signed component, as a register holds it. */
static inline int nv2a_signed_texel(int byte) {
    return byte > 127 ? 2 * byte - 512 : 2 * byte;
}

/* A pair's luminance with its chrominance. */
static inline void nv2a_ycbcr(int y, int cb, int cr, int result[3]) {
    int light = (298 * y - 4864) >> 8, u = cb - 128, v = cr - 128;
    result[0] = nv2a_clamp(light + 2 * ((409 * v + 128) >> 9), 0, 255);
    result[1] = nv2a_clamp(light + 1 - 2 * ((100 * u) >> 9) - 2 * ((208 * v) >> 9), 0, 255);
    result[2] = nv2a_clamp(light + ((516 * u) >> 8), 0, 255);
}

/* ------------------------------------------------------------------------------------ compressed textures */

/* What DXT1 takes off red, green and blue, a place of 4 by 4 texels, the row at t = 0 first. */
static const int nv2a_dither_red[16] = {0, 4, 1, 5, 2, 6, 3, 7, 5, 1, 4, 0, 7, 3, 6, 2};
static const int nv2a_dither_green[16] = {3, 1, 2, 0, 2, 0, 1, 3, 1, 3, 0, 2, 0, 2, 3, 1};
static const int nv2a_dither_blue[16] = {7, 3, 6, 2, 5, 1, 4, 0, 2, 6, 3, 7, 0, 4, 1, 5};

static inline int nv2a_dithered(int v, int taken, int step) {
    int kept = nv2a_most(v - taken, 0) / step;
    if (kept == 0) return 0;
    if (kept == 255 / step) return 255;
    return step * kept + taken + step / 2 - 1;
}

/* A colour of a block's four: its two ends, and thirds, or the middle and nothing. */
static inline void nv2a_block_color(uint32_t ends, int code, int half_way, int result[4]) {
    int a[4], b[4];
    nv2a_texel_r5g6b5((int)(ends & 0xffffu), a);
    nv2a_texel_r5g6b5((int)(ends >> 16), b);
    for (int k = 0; k < 4; k++) {
        if (code == 0) result[k] = a[k];
        else if (code == 1) result[k] = b[k];
        else if (half_way != 0) result[k] = code == 2 ? (a[k] + b[k] + 1) / 2 : 0;
        else result[k] = code == 2 ? (2 * a[k] + b[k] + 1) / 3 : (a[k] + 2 * b[k] + 1) / 3;
    }
}

static inline uint32_t nv2a_texel_word(const int c[4]) {
    return (uint32_t)c[0] | (uint32_t)c[1] << 8 | (uint32_t)c[2] << 16 | (uint32_t)c[3] << 24;
}

/* Rules dxt1, dxt3, dxt5: a block's words, the first byte lowest, as 16 texels, red the lowest byte. */
static inline void nv2a_dxt1(const uint32_t block[2], uint32_t texels[16]) {
    int half_way = (block[0] & 0xffffu) <= block[0] >> 16;
    for (int i = 0; i < 16; i++) {
        int c[4];
        nv2a_block_color(block[0], (int)(block[1] >> (2 * i) & 3u), half_way, c);
        c[0] = nv2a_dithered(c[0], nv2a_dither_red[i], 8);
        c[1] = nv2a_dithered(c[1], nv2a_dither_green[i], 4);
        c[2] = nv2a_dithered(c[2], nv2a_dither_blue[i], 8);
        texels[i] = nv2a_texel_word(c);
    }
}

static inline void nv2a_dxt3(const uint32_t block[4], uint32_t texels[16]) {
    for (int i = 0; i < 16; i++) {
        int c[4];
        nv2a_block_color(block[2], (int)(block[3] >> (2 * i) & 3u), 0, c);
        c[3] = 17 * (int)(block[i >> 3] >> (4 * (i & 7)) & 15u);
        texels[i] = nv2a_texel_word(c);
    }
}

static inline int nv2a_block_alpha(uint32_t ends, int code) {
    int a = (int)(ends & 255u), b = (int)(ends >> 8 & 255u), steps = a > b ? 7 : 5;
    if (code == 0) return a;
    if (code == 1) return b;
    if (code - 1 < steps) return ((steps - code + 1) * a + (code - 1) * b + steps / 2) / steps;
    return code == 6 ? 0 : 255;
}

static inline void nv2a_dxt5(const uint32_t block[4], uint32_t texels[16]) {
    uint64_t codes = (uint64_t)(block[0] >> 16) | (uint64_t)block[1] << 16;
    for (int i = 0; i < 16; i++) {
        int c[4];
        nv2a_block_color(block[2], (int)(block[3] >> (2 * i) & 3u), 0, c);
        c[3] = nv2a_block_alpha(block[0], (int)(uint32_t)(codes >> (3 * i)) & 7);
        texels[i] = nv2a_texel_word(c);
    }
}

#endif
