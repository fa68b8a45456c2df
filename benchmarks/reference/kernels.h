/* Trigonometry of the hand-written references: libm's, or with REFERENCE_INLINE polynomials for angles up to
 * +-100 rad. The coefficients are minimax (relative error of the sine and the arctangent 5e-9 and 1.5e-8, absolute
 * error of the cosine 4e-10): below what float arithmetic rounds. */
#ifndef REFERENCE_KERNELS_H
#define REFERENCE_KERNELS_H

#include <math.h>
#include <stdint.h>

/* a b + c in one instruction where there is one. */
#if defined(__ARM_FEATURE_FMA)
#define MADD(a, b, c) fmaf((a), (b), (c))
#else
#define MADD(a, b, c) ((a) * (b) + (c))
#endif

/* gcc would call what is used four times. */
#define INLINE static inline __attribute__((always_inline))

#define PI 3.14159265f
#define HALF_PI 1.57079633f

INLINE uint32_t bits(float x)
{
    uint32_t u;
    __builtin_memcpy(&u, &x, sizeof u);
    return u;
}

INLINE float of_bits(uint32_t u)
{
    float x;
    __builtin_memcpy(&x, &u, sizeof x);
    return x;
}

/* x as k half turns and a rest: k's parity in the top bit, the rest in [-pi/2, pi/2]. */
INLINE uint32_t half_turns(float x, float *rest)
{
    const float k = MADD(x, 0.318309886f, 12582912.0f);
    const float n = k - 12582912.0f;
    *rest = MADD(n, 8.74227766e-8f, MADD(n, -3.14159274f, x));
    return bits(k) << 31;
}

/* A vector of signed length a at angle x: (a cos x, a sin x). Half a turn is a sign of a: no quadrants. */
INLINE void polar(float a, float x, float *along, float *across)
{
#ifdef REFERENCE_INLINE
    float r;
    const float b = of_bits(bits(a) ^ half_turns(x, &r));
    const float z = r * r;
    float s = MADD(z, 2.6089297e-06f, -0.00019811111f);
    float c = MADD(z, -2.6193788e-07f, 2.4769302e-05f);
    s = MADD(z, s, 0.008333088f);
    c = MADD(z, c, -0.0013888569f);
    s = MADD(z, s, -0.16666661f);
    c = MADD(z, c, 0.041666657f);
    c = MADD(z, c, -0.5f);
    *along = b * MADD(z, c, 1.0f);
    *across = b * MADD(r * z, s, r);
#else
    *along = a * cosf(x);
    *across = a * sinf(x);
#endif
}

/* cos and sin of x. */
INLINE void turn(float x, float *c, float *s)
{
#ifdef REFERENCE_INLINE
    polar(1.0f, x, c, s);
#else
    *c = cosf(x);
    *s = sinf(x);
#endif
}

/* atan of q in [-1, 1]. */
INLINE float arctangent(float q)
{
    const float z = q * q;
    float p = MADD(z, 0.0029745866f, -0.016581168f);
    p = MADD(z, p, 0.043553516f);
    p = MADD(z, p, -0.07580576f);
    p = MADD(z, p, 0.106789395f);
    p = MADD(z, p, -0.14214209f);
    p = MADD(z, p, 0.19994137f);
    p = MADD(z, p, -0.33333167f);
    return MADD(q * z, p, q);
}

/* Direction of (x, y) in [-pi, pi]; 0 of (0, 0). */
INLINE float direction(float y, float x)
{
#ifdef REFERENCE_INLINE
    const float ax = fabsf(x), ay = fabsf(y);
    const int steep = ax < ay;
    const float near = steep ? ax : ay, far = steep ? ay : ax;
    float a = arctangent(near / (far == 0.0f ? 1.0f : far));
    a = steep ? HALF_PI - a : a;
    a = x < 0.0f ? PI - a : a;
    return of_bits(bits(a) | (bits(y) & 0x80000000u));
#else
    return atan2f(y, x);
#endif
}

/* atan of q in [-1, 1], as chosen. */
INLINE float slope_angle(float q)
{
#ifdef REFERENCE_INLINE
    return arctangent(q);
#else
    return atanf(q);
#endif
}

#endif
