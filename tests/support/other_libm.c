/* Another computer's library of mathematics: results that are not exact are one last bit larger.
 *
 * Preloaded, its functions stand before those of the C library. Squares, whole powers and roots stay, as every library
 * rounds them right. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

static double larger(double x) {
    uint64_t bits;
    if (x == rint(x) || !isfinite(x)) return x;
    memcpy(&bits, &x, 8);
    bits += 1;
    memcpy(&x, &bits, 8);
    return x;
}

#define OF_ONE(name) \
    double name(double x) { \
        static double (*of)(double); \
        if (!of) of = dlsym(RTLD_NEXT, #name); \
        return larger(of(x)); \
    }
#define OF_TWO(name) \
    double name(double x, double y) { \
        static double (*of)(double, double); \
        if (!of) of = dlsym(RTLD_NEXT, #name); \
        return larger(of(x, y)); \
    }

OF_ONE(sin) OF_ONE(cos) OF_ONE(tan) OF_ONE(asin) OF_ONE(acos) OF_ONE(atan) OF_ONE(sinh) OF_ONE(cosh) OF_ONE(tanh)
OF_ONE(exp) OF_ONE(exp2) OF_ONE(expm1) OF_ONE(log) OF_ONE(log2) OF_ONE(log10) OF_ONE(log1p) OF_ONE(cbrt)
OF_TWO(atan2) OF_TWO(hypot)

double pow(double x, double y) {
    static double (*of)(double, double);
    if (!of) of = dlsym(RTLD_NEXT, "pow");
    return y == rint(y) || y == 0.5 ? of(x, y) : larger(of(x, y));
}

void sincos(double x, double *s, double *c) {
    static void (*of)(double, double *, double *);
    if (!of) of = dlsym(RTLD_NEXT, "sincos");
    of(x, s, c);
    *s = larger(*s);
    *c = larger(*c);
}
