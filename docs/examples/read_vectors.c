/* Reads blending.json and frames as `fixedpipe golden export` writes them, blends in integers, and counts what
 * agrees. C99 without libraries:  cc -O2 -o read_vectors read_vectors.c && ./read_vectors DIR
 *
 * A case has a line of its own, so a line is read and its keys are looked for: no JSON library is needed.
 * The blending unit rounds once, after the sum: clamp(rn(S Fs + D Fd)), rn(n) = floor(n / 255 + 1 / 2). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 16, LINE = 1 << 20 };
static char line[LINE];

/* What follows "key": in the line, or NULL. */
static const char *after(const char *text, const char *key) {
    char wanted[64];
    snprintf(wanted, sizeof wanted, "\"%s\": ", key);
    const char *found = strstr(text, wanted);
    return found ? found + strlen(wanted) : NULL;
}

/* The next `count` whole numbers of a list, however deep its brackets. */
static int numbers(const char *text, int *out, int count) {
    for (int k = 0; k < count; k++) {
        while (*text && !(*text >= '0' && *text <= '9')) text++;
        if (!*text) return 0;
        out[k] = (int)strtol(text, (char **)&text, 10);
    }
    return 1;
}

static void word(const char *text, char *out) {
    if (sscanf(text, "\"%39[A-Z_0-9]\"", out) != 1) *out = 0;
}

static int factor(const char *name, int c, const int *s, const int *d, const int *k) {
    int minus = !strncmp(name, "ONE_MINUS_", 10), f = 0;
    const char *of = minus ? name + 10 : name;
    if (!strcmp(of, "ONE")) f = 255;
    else if (!strcmp(of, "SRC_COLOR")) f = s[c];
    else if (!strcmp(of, "DST_COLOR")) f = d[c];
    else if (!strcmp(of, "SRC_ALPHA")) f = s[3];
    else if (!strcmp(of, "DST_ALPHA")) f = d[3];
    else if (!strcmp(of, "CONSTANT_COLOR")) f = k[c];
    else if (!strcmp(of, "CONSTANT_ALPHA")) f = k[3];
    else if (!strcmp(of, "SRC_ALPHA_SATURATE")) f = c == 3 ? 255 : s[3] < 255 - d[3] ? s[3] : 255 - d[3];
    return minus ? 255 - f : f;
}

static int blend(const char *equation, int s, int fs, int d, int fd) {
    int a = s * fs, b = d * fd, n;
    if (!strcmp(equation, "MIN")) return s < d ? s : d;
    if (!strcmp(equation, "MAX")) return s > d ? s : d;
    if (!strcmp(equation, "FUNC_SUBTRACT")) n = a - b;
    else if (!strcmp(equation, "FUNC_REVERSE_SUBTRACT")) n = b - a;
    else n = a + b;
    n = n < 0 ? 0 : (2 * n + 255) / 510;
    return n > 255 ? 255 : n;
}

int main(int count, char **arguments) {
    char path[4096], equation[40], source[40], destination[40];
    long equal = 0, of = 0, pixels = 0, opaque = 0;
    if (count != 2) return fprintf(stderr, "usage: read_vectors DIR\n"), 2;
    snprintf(path, sizeof path, "%s/blending.json", arguments[1]);
    FILE *file = fopen(path, "rb");
    if (!file) return perror(path), 2;
    while (fgets(line, LINE, file)) {
        int s[4 * POINTS], d[4 * POINTS], e[4 * POINTS], k[4];
        if (!after(line, "equation")) continue; /* the first line and the last hold no case */
        word(after(line, "equation"), equation), word(after(line, "source"), source);
        word(after(line, "destination"), destination);
        if (strstr(equation, "SIGNED")) continue; /* the NV2A's own, of two's complement bytes */
        if (!numbers(after(line, "fragment"), s, 4 * POINTS) || !numbers(after(line, "stored"), d, 4 * POINTS) ||
            !numbers(after(line, "expected"), e, 4 * POINTS) || !numbers(after(line, "constant"), k, 4))
            return fprintf(stderr, "%s: a case lacks numbers\n", path), 2;
        for (int p = 0; p < 4 * POINTS; p++) {
            const int *sp = s + p / 4 * 4, *dp = d + p / 4 * 4, c = p % 4;
            int fs = factor(source, c, sp, dp, k), fd = factor(destination, c, sp, dp, k);
            equal += blend(equation, s[p], fs, d[p], fd) == e[p], of++;
        }
    }
    fclose(file);
    snprintf(path, sizeof path, "%s/frames/000000.rgba", arguments[1]);
    if ((file = fopen(path, "rb"))) { /* the top row first, four bytes a pixel */
        for (unsigned char rgba[4]; fread(rgba, 4, 1, file) == 1; pixels++) opaque += rgba[3] == 255;
        fclose(file);
    }
    printf("blending: %ld of %ld components equal; frame 0: %ld pixels, %ld opaque\n", equal, of, pixels, opaque);
    return equal == of && of > 0 ? 0 : 1;
}
