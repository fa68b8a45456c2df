/* Eight swerve modules on an ellipse with half-axes 1.5 m and 1 m, radius 0.1 m. */
#include "swerve8.h"
#include "steer.h"

/* The branch nearest the present angle, held at standstill. */
void swerve8_inverse_nearest(const swerve8_inverse_in *in, swerve8_inverse_out *out)
{
    const float x = in->vx, y = in->vy, w = in->omega;
    const float right = MADD(0.7071f, w, x), left = MADD(-0.7071f, w, x);
    const float front = MADD(1.0607f, w, y), back = MADD(-1.0607f, w, y);
    out->w0.spin = steer(x, MADD(1.5f, w, y), 10.0f, in->w0.steer, &out->w0.steer);
    out->w1.spin = steer(left, front, 10.0f, in->w1.steer, &out->w1.steer);
    out->w2.spin = steer(x - w, y, 10.0f, in->w2.steer, &out->w2.steer);
    out->w3.spin = steer(left, back, 10.0f, in->w3.steer, &out->w3.steer);
    out->w4.spin = steer(x, MADD(-1.5f, w, y), 10.0f, in->w4.steer, &out->w4.steer);
    out->w5.spin = steer(right, back, 10.0f, in->w5.steer, &out->w5.steer);
    out->w6.spin = steer(x + w, y, 10.0f, in->w6.steer, &out->w6.steer);
    out->w7.spin = steer(right, front, 10.0f, in->w7.steer, &out->w7.steer);
}

/* Least squares; the modules are placed symmetrically, so sums of positions vanish. */
void swerve8_forward_reference(const swerve8_forward_in *in, swerve8_forward_out *out)
{
    float ax, ay, bx, by;
    polar(in->w0.spin, in->w0.steer, &ax, &ay);
    polar(in->w4.spin, in->w4.steer, &bx, &by);
    float x = ax + bx, y = ay + by;
    float w = 0.0115381948f * (ay - by);
    polar(in->w2.spin, in->w2.steer, &ax, &ay);
    polar(in->w6.spin, in->w6.steer, &bx, &by);
    x += ax + bx;
    y += ay + by;
    w = MADD(0.00769212988f, bx - ax, w);
    polar(in->w1.spin, in->w1.steer, &ax, &ay);
    polar(in->w3.spin, in->w3.steer, &bx, &by);
    const float left = ax + bx;
    float front = ay, back = by;
    polar(in->w7.spin, in->w7.steer, &ax, &ay);
    polar(in->w5.spin, in->w5.steer, &bx, &by);
    const float right = ax + bx;
    front += ay;
    back += by;
    w = MADD(0.00543910503f, right - left, w);
    out->vx = 0.0125f * (x + (left + right));
    out->vy = 0.0125f * (y + (front + back));
    out->omega = MADD(0.00815904222f, front - back, w);
}
