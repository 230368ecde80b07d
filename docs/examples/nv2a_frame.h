/* Writes a frame of the NV2A's words, vertices and memory, as docs/nv2a-frames.md describes it. MIT licence.
 *
 *     FILE *f = fopen("frame.nv2a", "wb");
 *     nv2a_frame_begin(f, 640, 480, NV2A_DEPTH_FIXED_24);
 *     nv2a_frame_memory(f, 0x10000, texels, 65536);
 *     nv2a_frame_word(f, 0x1d94, 0xf3);                        a method of class 0x97, and its value
 *     nv2a_frame_word(f, 0x17fc, 5);                           SET_BEGIN_END: triangles
 *     nv2a_frame_vertices(f, 1u << 0 | 1u << 3, vertices, 3);  position and diffuse, four floats each
 *     nv2a_frame_word(f, 0x17fc, 0);
 *
 * Each function returns 1, or 0 where the file could not be written. It works in any byte order. */
#ifndef NV2A_FRAME_H
#define NV2A_FRAME_H

#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { NV2A_DEPTH_FIXED_16, NV2A_DEPTH_FLOAT_16, NV2A_DEPTH_FIXED_24, NV2A_DEPTH_FLOAT_24 };
enum { NV2A_FRAME_WORDS = 1, NV2A_FRAME_MEMORY, NV2A_FRAME_VERTICES };

static int nv2a_frame_put(FILE *file, uint32_t word) {
    unsigned char bytes[4];
    for (int k = 0; k < 4; k++) bytes[k] = (unsigned char)(word >> 8 * k);
    return fwrite(bytes, 1, 4, file) == 4;
}

static int nv2a_frame_record(FILE *file, uint32_t kind, uint32_t place, uint32_t count) {
    return nv2a_frame_put(file, kind) && nv2a_frame_put(file, place) && nv2a_frame_put(file, count);
}

/* The head: the window's size in pixels and its depth buffer. */
static inline int nv2a_frame_begin(FILE *file, uint32_t width, uint32_t height, uint32_t depth) {
    return fwrite("NV2AFRM1", 1, 8, file) == 8 && nv2a_frame_record(file, width, height, depth);
}

/* Words for consecutive registers, the first of them ``method``. */
static inline int nv2a_frame_words(FILE *file, uint32_t method, const uint32_t *words, uint32_t count) {
    int done = nv2a_frame_record(file, NV2A_FRAME_WORDS, method, count);
    for (uint32_t k = 0; k < count; k++) done = done && nv2a_frame_put(file, words[k]);
    return done;
}

static inline int nv2a_frame_word(FILE *file, uint32_t method, uint32_t word) {
    return nv2a_frame_words(file, method, &word, 1);
}

/* Bytes of memory from ``address`` on, for textures that are set later. */
static inline int nv2a_frame_memory(FILE *file, uint32_t address, const void *bytes, uint32_t count) {
    static const unsigned char zeros[4] = {0, 0, 0, 0};
    size_t rest = (4 - count % 4) % 4;
    return nv2a_frame_record(file, NV2A_FRAME_MEMORY, address, count) && fwrite(bytes, 1, count, file) == count &&
           fwrite(zeros, 1, rest, file) == rest;
}

/* Vertices: for each, four floats for every slot whose bit is set, in the slots' order. */
static inline int nv2a_frame_vertices(FILE *file, uint32_t slots, const float *values, uint32_t count) {
    uint32_t each = 0;
    for (uint32_t rest = slots; rest != 0; rest &= rest - 1) each += 4;
    int done = nv2a_frame_record(file, NV2A_FRAME_VERTICES, slots, count);
    for (size_t k = 0; k < (size_t)each * count; k++) {
        uint32_t word;
        memcpy(&word, &values[k], 4);
        done = done && nv2a_frame_put(file, word);
    }
    return done;
}

#endif
