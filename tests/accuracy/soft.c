/* Products, quotients and roots in integers against those of this processor. Prints how many differ, and in which. */
#include "soft.c"
#include <stdio.h>
#include <stdlib.h>

static uint64_t state = 88172645463325252ULL;

static uint64_t next(void)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state;
}

static float of(uint32_t bits)
{
    wmrgen_word w;
    w.bits = bits;
    return w.value;
}

static int differ(float a, float b)
{
    wmrgen_word v, w;
    v.value = a;
    w.value = b;
    return (a == a || b == b) && v.bits != w.bits;
}

/* Any two floats; of one magnitude; with few bits set, or few not set, where products and quotients lie near half-way. */
static void pair(uint64_t k, float *a, float *b)
{
    const uint64_t bits = next();
    uint32_t u = (uint32_t)bits, v = (uint32_t)(bits >> 32);
    const uint32_t few = (uint32_t)(k >> 3) % 24U, many = (uint32_t)(k >> 8) % 24U;
    if ((k & 1U) != 0U) {
        u = (u & 0x807fffffU) | ((100U + (uint32_t)(k >> 3) % 60U) << 23);
        v = (v & 0x807fffffU) | (127U << 23);
    }
    if ((k & 6U) == 6U) {
        u |= 0x7fffffU >> few;
        v &= ~(0x7fffffU >> many);
    }
    if ((k & 6U) == 4U) {
        v |= 0x7fffffU >> few;
        u &= 0xff800000U | ((1U << many) - 1U);
    }
    if ((k & 6U) == 2U) {
        u &= ~((1U << few) - 1U);
        v &= ~((1U << many) - 1U);
    }
    *a = of(u);
    *b = of(v);
}

/* How many pairs; one in how many floats between 1 and 4, which have every mantissa of a root. */
int main(int count, char **words)
{
    const uint64_t pairs = strtoull(words[1], NULL, 10);
    const uint32_t step = (uint32_t)strtoul(words[2], NULL, 10);
    unsigned long product = 0UL, quotient = 0UL, root = 0UL;
    uint64_t k;
    uint32_t bits;
    float a, b;
    (void)count;
    for (k = 0; k < pairs; ++k) {
        pair(k, &a, &b);
        product += (unsigned long)differ(wmrgen_mul(a, b), a * b);
        quotient += (unsigned long)differ(wmrgen_div(a, b), a / b);
        if (k % 16U == 0U) { /* any exponent; every mantissa follows */
            root += (unsigned long)differ(wmrgen_sqrt(a), sqrtf(a));
        }
    }
    for (bits = 0x3f800000U; bits < 0x40800000U; bits += step) {
        root += (unsigned long)differ(wmrgen_sqrt(of(bits)), sqrtf(of(bits)));
    }
    printf("%lu %lu %lu\n", product, quotient, root);
    return 0;
}
