/* Eight swerve modules on an ellipse with half-axes 1.5 m and 1 m, radius 0.1 m. */
#include "swerve8.h"
#include "steer.h"

/* The branch nearest the present angle, held at standstill. */
void swerve8_inverse_nearest(const swerve8_twist *twist, const swerve8_wheels *now, swerve8_wheels *out)
{
    const float x = twist->vx, y = twist->vy, w = twist->omega;
    const float right = MADD(0.7071f, w, x), left = MADD(-0.7071f, w, x);
    const float front = MADD(1.0607f, w, y), back = MADD(-1.0607f, w, y);
    out->w0.spin = steer(x, MADD(1.5f, w, y), 10.0f, now->w0.steer, &out->w0.steer);
    out->w1.spin = steer(left, front, 10.0f, now->w1.steer, &out->w1.steer);
    out->w2.spin = steer(x - w, y, 10.0f, now->w2.steer, &out->w2.steer);
    out->w3.spin = steer(left, back, 10.0f, now->w3.steer, &out->w3.steer);
    out->w4.spin = steer(x, MADD(-1.5f, w, y), 10.0f, now->w4.steer, &out->w4.steer);
    out->w5.spin = steer(right, back, 10.0f, now->w5.steer, &out->w5.steer);
    out->w6.spin = steer(x + w, y, 10.0f, now->w6.steer, &out->w6.steer);
    out->w7.spin = steer(right, front, 10.0f, now->w7.steer, &out->w7.steer);
}

/* Least squares; the modules are placed symmetrically, so sums of positions vanish. */
void swerve8_forward_reference(const swerve8_wheels *wheels, swerve8_twist *out)
{
    float ax, ay, bx, by;
    polar(wheels->w0.spin, wheels->w0.steer, &ax, &ay);
    polar(wheels->w4.spin, wheels->w4.steer, &bx, &by);
    float x = ax + bx, y = ay + by;
    float w = 0.0115381948f * (ay - by);
    polar(wheels->w2.spin, wheels->w2.steer, &ax, &ay);
    polar(wheels->w6.spin, wheels->w6.steer, &bx, &by);
    x += ax + bx;
    y += ay + by;
    w = MADD(0.00769212988f, bx - ax, w);
    polar(wheels->w1.spin, wheels->w1.steer, &ax, &ay);
    polar(wheels->w3.spin, wheels->w3.steer, &bx, &by);
    const float left = ax + bx;
    float front = ay, back = by;
    polar(wheels->w7.spin, wheels->w7.steer, &ax, &ay);
    polar(wheels->w5.spin, wheels->w5.steer, &bx, &by);
    const float right = ax + bx;
    front += ay;
    back += by;
    w = MADD(0.00543910503f, right - left, w);
    out->vx = 0.0125f * (x + (left + right));
    out->vy = 0.0125f * (y + (front + back));
    out->omega = MADD(0.00815904222f, front - back, w);
}
