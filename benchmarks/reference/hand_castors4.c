/* Four powered castors, pivots at (+-0.2, +-0.2) m, offset d 0.02 m, radius 0.055 m. */
#include "nomad_xr4000.h"
#include "kernels.h"

/* Spin and steering rate of a castor whose pivot moves with (x, y) / d. */
#define CASTOR(name, x, y)                                            \
    do {                                                              \
        float c, s;                                                   \
        turn(now->name.steer, &c, &s);                                \
        out->name.spin = 0.363636364f * MADD(c, (x), s * (y));        \
        out->name.steer_rate = MADD(c, (y), MADD(-s, (x), -w));       \
    } while (0)

void castors4_inverse(const nomad_xr4000_twist *twist, const nomad_xr4000_wheels *now, nomad_xr4000_wheels *out)
{
    const float w = twist->omega, vx = 50.0f * twist->vx, vy = 50.0f * twist->vy;
    const float left = MADD(-10.0f, w, vx), right = MADD(10.0f, w, vx);
    const float front = MADD(10.0f, w, vy), back = MADD(-10.0f, w, vy);
    CASTOR(castor1, left, front);
    CASTOR(castor2, right, front);
    CASTOR(castor3, left, back);
    CASTOR(castor4, right, back);
}

/* Velocity of a contact point in units of d, from spin and steering rate: u = R(steer) (r/d spin, rate). */
#define CONTACT(name, c, s, x, y)                                     \
    do {                                                              \
        const float a = 2.75f * wheels->name.spin;                    \
        turn(wheels->name.steer, &c, &s);                             \
        x = MADD(c, a, -(s * wheels->name.steer_rate));               \
        y = MADD(s, a, c * wheels->name.steer_rate);                  \
    } while (0)

/* Rigid-body fit of the contact velocities u at p = pivot - d (c, s), in sums that the geometry collapses:
 * p x u = pivot x u - d^2 rate, |p|^2 = |pivot|^2 + d^2 - 2 d pivot.(c, s), and the pivots add to zero. */
void castors4_forward(const nomad_xr4000_wheels *wheels, nomad_xr4000_twist *out)
{
    float c1, s1, x1, y1, c2, s2, x2, y2, c3, s3, x3, y3, c4, s4, x4, y4;
    CONTACT(castor1, c1, s1, x1, y1);
    CONTACT(castor2, c2, s2, x2, y2);
    const float cf = c1 + c2, yf = y1 + y2;
    CONTACT(castor3, c3, s3, x3, y3);
    const float sl = s1 + s3, xl = x1 + x3;
    CONTACT(castor4, c4, s4, x4, y4);
    const float cb = c3 + c4, yb = y3 + y4, sr = s2 + s4, xr = x2 + x4;
    const float rates = (wheels->castor1.steer_rate + wheels->castor2.steer_rate)
        + (wheels->castor3.steer_rate + wheels->castor4.steer_rate);
    const float c = cf + cb, s = sl + sr, x = xl + xr, y = yf + yb;
    const float moment = MADD(40.0f, (yf - yb) - (xl - xr), MADD(-4.0f, rates, MADD(c, y, -(s * x))));
    const float inertia = MADD(-80.0f, (cf - cb) + (sl - sr), 3216.0f) - MADD(c, c, s * s);
    const float w = moment / inertia;
    out->vx = 0.005f * MADD(-w, s, x);
    out->vy = 0.005f * MADD(w, c, y);
    out->omega = w;
}
