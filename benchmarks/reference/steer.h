/* Where a steered wheel turns. */
#ifndef REFERENCE_STEER_H
#define REFERENCE_STEER_H

#include "kernels.h"

/* The angle nearest ``present`` on the line of (x, y), held where both are 0; the signed speed times ``scale``.
 * Half the angle of the line has the tangent y / (x +- speed), the sign that of x: in [-1, 1], and nothing cancels. */
INLINE float steer(float x, float y, float scale, float present, float *angle)
{
    const float speed = sqrtf(MADD(x, x, y * y));
    const float along = of_bits(bits(speed) | (bits(x) & 0x80000000u));
    const float slope = y / (speed == 0.0f ? 1.0f : along + x);
    float rest;
    const uint32_t reversed = half_turns(MADD(2.0f, slope_angle(slope), -present), &rest);
    *angle = present + (speed == 0.0f ? 0.0f : rest);
    return of_bits(bits(scale * along) ^ reversed);
}

#endif
