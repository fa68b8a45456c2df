/* Worst error of a kernel over all floats from one to another, by their bits. Prints it, where it is, and how many. */
#include "kernel.c"
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Small arguments by their series, which is exact enough for a float and quicker than libm. */
static double exact_sine(double x)
{
    const double s = x * x;
    return x < 0x1p-6 ? x - x * s * (1.0 / 6 - s / 120) : sin(x);
}

static double exact_cosine(double x)
{
    const double s = x * x;
    return x < 0x1p-6 ? 1 - s * (0.5 - s * (1.0 / 24 - s / 720)) : cos(x);
}

static double exact_arctangent(double x)
{
    const double s = x * x;
    return x < 0x1p-6 ? x - x * s * (1.0 / 3 - s * (0.2 - s * (1.0 / 7 - s / 9))) : atan(x);
}

/* Of `absolute` the unit is 2^-24, half an ulp of 1; otherwise that of the exact value. */
#define TRY(name)                                                                     \
    for (uint32_t bits = first; bits <= last; bits += step) {                         \
        kernel_##name##_in in;                                                        \
        kernel_##name##_out out;                                                      \
        memcpy(&in.x, &bits, sizeof in.x);                                            \
        kernel_##name(&in, &out);                                                     \
        const double wanted = exact_##name((double)in.x);                             \
        const float near = (float)wanted;                                             \
        uint32_t place;                                                               \
        memcpy(&place, &near, sizeof place);                                          \
        place = (place & 0x7f800000U) > 0x0c000000U ? (place & 0x7f800000U) - 0x0b800000U : 1U; \
        float unit;                                                                   \
        memcpy(&unit, &place, sizeof unit);                                           \
        const double error = fabs((double)out.y - wanted) / (absolute ? 0x1p-24 : (double)unit); \
        if (!(error <= worst)) {                                                      \
            worst = error;                                                            \
            where = in.x;                                                             \
        }                                                                             \
        ++count;                                                                      \
    }

int main(int argc, char **argv)
{
    if (argc != 6) {
        return 2;
    }
    const uint32_t first = (uint32_t)strtoul(argv[2], NULL, 0), last = (uint32_t)strtoul(argv[3], NULL, 0);
    const uint32_t step = (uint32_t)strtoul(argv[4], NULL, 0);
    const int absolute = argv[5][0] == 'a';
    double worst = 0;
    float where = 0;
    unsigned long count = 0;
    if (strcmp(argv[1], "sine") == 0) {
        TRY(sine)
    } else if (strcmp(argv[1], "cosine") == 0) {
        TRY(cosine)
    } else {
        TRY(arctangent)
    }
    printf("%.17g %.9g %lu\n", worst, where, count);
    return 0;
}
