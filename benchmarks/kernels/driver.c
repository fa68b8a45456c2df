/* Worst error of a kernel over all floats from one to another, by their bits. Prints it, where it is, and how many.
 * It goes by blocks, in loops that a compiler makes vectors of. */
#include "kernel.c"
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
/* Powers of x that are subnormal take a processor a hundred times as long, where |x| is 2^-75 to 2^-42. They are less
 * than 2^-50 of the x, or 1, that they are added to: whether they are 0 makes no difference. */
#define SUBNORMAL_POWERS_ARE_ZERO(flag) _MM_SET_FLUSH_ZERO_MODE((flag) ? _MM_FLUSH_ZERO_ON : _MM_FLUSH_ZERO_OFF)
#else
#define SUBNORMAL_POWERS_ARE_ZERO(flag)
#endif

#define BLOCK 1024

/* Arguments below SMALL by their series, which is exact enough for a float. */
#define SMALL 0x1p-6
#define SERIES_SINE(x, s) (x - x * s * (1.0 / 6 - s / 120))
#define SERIES_COSINE(x, s) (1 - s * (0.5 - s * (1.0 / 24 - s / 720)))
#define SERIES_ARCTANGENT(x, s) (x - x * s * (1.0 / 3 - s * (0.2 - s * (1.0 / 7 - s / 9))))

static uint32_t bits[BLOCK];
static float at[BLOCK], got[BLOCK];
static double exact[BLOCK], errors[BLOCK];

#define DEFINE(name, series, libm)                              \
    static void name##_block(void)                              \
    {                                                           \
        for (int i = 0; i < BLOCK; ++i) {                       \
            kernel_##name##_in in;                              \
            kernel_##name##_out out;                            \
            in.x = at[i];                                       \
            kernel_##name(&in, &out);                           \
            got[i] = out.y;                                     \
        }                                                       \
        if (at[BLOCK - 1] < (float)SMALL) {                     \
            for (int i = 0; i < BLOCK; ++i) {                   \
                const double x = (double)at[i], s = x * x;      \
                exact[i] = series(x, s);                        \
            }                                                   \
        } else {                                                \
            for (int i = 0; i < BLOCK; ++i) {                   \
                exact[i] = libm((double)at[i]);                 \
            }                                                   \
        }                                                       \
    }

DEFINE(sine, SERIES_SINE, sin)
DEFINE(cosine, SERIES_COSINE, cos)
DEFINE(arctangent, SERIES_ARCTANGENT, atan)

/* Of `absolute` the unit is 2^-24, half an ulp of 1; otherwise that of the exact value. Gives how many are not within
 * `worst`. */
static int judged(int absolute, double worst)
{
    static float near[BLOCK], unit[BLOCK];
    static uint32_t place[BLOCK];
    int beyond = 0;
    for (int i = 0; i < BLOCK; ++i) {
        near[i] = (float)exact[i];
    }
    memcpy(place, near, sizeof place);
    for (int i = 0; i < BLOCK; ++i) {
        const uint32_t power = place[i] & 0x7f800000U;
        place[i] = power > 0x0c000000U ? power - 0x0b800000U : 1U;
    }
    memcpy(unit, place, sizeof unit);
    for (int i = 0; i < BLOCK; ++i) {
        errors[i] = fabs((double)got[i] - exact[i]) / (absolute ? 0x1p-24 : (double)unit[i]);
        beyond += !(errors[i] <= worst);
    }
    return beyond;
}

int main(int argc, char **argv)
{
    if (argc != 6) {
        return 2;
    }
    const uint32_t first = (uint32_t)strtoul(argv[2], NULL, 0), last = (uint32_t)strtoul(argv[3], NULL, 0);
    const uint32_t step = (uint32_t)strtoul(argv[4], NULL, 0);
    const int absolute = argv[5][0] == 'a';
    const uint32_t total = (last - first) / step + 1;
    double worst = 0;
    float where = 0;
    for (uint32_t done = 0; done < total; done += BLOCK) {
        const uint32_t count = total - done < BLOCK ? total - done : BLOCK;
        for (uint32_t i = 0; i < BLOCK; ++i) { /* the last block repeats its last float */
            bits[i] = first + (done + (i < count ? i : count - 1)) * step;
        }
        memcpy(at, bits, sizeof at);
        SUBNORMAL_POWERS_ARE_ZERO(step == 1 && at[0] >= 0x1p-100f);
        if (strcmp(argv[1], "sine") == 0) {
            sine_block();
        } else if (strcmp(argv[1], "cosine") == 0) {
            cosine_block();
        } else {
            arctangent_block();
        }
        if (judged(absolute, worst)) {
            for (int i = 0; i < BLOCK; ++i) {
                if (!(errors[i] <= worst)) {
                    worst = errors[i];
                    where = at[i];
                }
            }
        }
    }
    printf("%.17g %.9g %lu\n", worst, where, (unsigned long)total);
    return 0;
}
