/* Reads files that `fixedpipe golden export DIR --rules` writes, computes seven rules in integers and bits, and
 * counts what agrees. C99 without libraries:  cc -O2 -o read_rules read_rules.c && ./read_rules DIR
 *
 * A case has a line of its own, so a line is read and its keys are looked for: no JSON library is needed. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char line[1 << 16];

/* What follows "key": in the line, or NULL. */
static const char *after(const char *key) {
    char wanted[64];
    snprintf(wanted, sizeof wanted, "\"%s\": ", key);
    const char *found = strstr(line, wanted);
    return found ? found + strlen(wanted) : NULL;
}

/* A whole number, or the bits of a number that is written as "0x3f800000". */
static long value(const char *key) {
    const char *text = after(key);
    if (!text) exit((fprintf(stderr, "a case has no %s: %s", key, line), 2));
    return *text == '"' ? (long)strtoul(text + 1, NULL, 16) : strtol(text, NULL, 10);
}

static long clamp(long x, long low, long high) { return x < low ? low : x > high ? high : x; }
static long floored(long n, long d) { return n / d - (n % d < 0); }
static long rn(long n) { return floored(2 * n + 255, 510); }

static long product(void) { return clamp(rn(value("a") * value("b")), -256, 255); }
static long expand(void) { long x = value("x"); return 2 * (x > 0 ? x : 0) - 256; }
static long blend(void) { return clamp(rn(value("s") * value("fs") + value("d") * value("fd")), 0, 255); }
static long filter(void) { return floored(value("p") * (256 - value("f")) + value("q") * value("f") + 128, 256); }
static long texel(void) { long s = value("byte"); return 2 * (s > 127 ? s - 256 : s); }

static long lerp(void) {
    long a = clamp(value("a"), 0, 255);
    return clamp(rn(a * value("b") + (255 - a) * value("c")) + value("d"), 0, 255);
}

/* 1/x of the transform unit: a seed of seven bits and two Newton steps, on the bits of single precision. */
static long reciprocal(void) {
    uint32_t x = (uint32_t)value("x"), sign = x & 0x80000000u, fraction = x & 0x7fffffu;
    int exponent = (int)(x >> 23 & 255);
    if (!exponent) return 0x7f800000; /* the sign of a zero is lost */
    if (exponent == 255) return 0;
    uint64_t m = fraction | 0x800000u, k = m >> 17 & 63, s = (32768 / (129 + 2 * k) + 1) / 2;
    uint64_t t = ((1ull << 31) - s * m) * s >> 24, best = ((1ull << 37) - t * m) * t >> 25;
    exponent = 254 - exponent - (fraction != 0);
    if (exponent < 1) return 0;
    return (long)(sign | (uint32_t)exponent << 23 | (fraction ? (uint32_t)(best & 0x7fffffu) : 0));
}

static const struct { const char *id; long (*compute)(void); } rules[] = {
    {"product", product}, {"mapping-expand-normal", expand}, {"final-lerp", lerp}, {"blend-func-add", blend},
    {"filter-step", filter}, {"signed-texel", texel}, {"reciprocal", reciprocal},
};

int main(int count, char **arguments) {
    int wrong = 0;
    if (count != 2) return fprintf(stderr, "usage: read_rules DIR\n"), 2;
    for (size_t k = 0; k < sizeof rules / sizeof *rules; k++) {
        char path[4096];
        long equal = 0, of = 0;
        snprintf(path, sizeof path, "%s/rules/%s.json", arguments[1], rules[k].id);
        FILE *file = fopen(path, "rb");
        if (!file) return perror(path), 2;
        while (fgets(line, sizeof line, file)) {
            if (!after("expected")) continue; /* the first line and the last hold no case */
            equal += rules[k].compute() == value("expected"), of++;
        }
        fclose(file);
        printf("%s: %ld of %ld\n", rules[k].id, equal, of);
        wrong += equal != of || !of;
    }
    return wrong != 0;
}
