/* Car: driven rear wheels at (0, +-0.75) m, steered front wheels at (2.5, +-0.75) m, radius 0.3 m, steering +-40 degrees. */
#include "ackermann_car.h"
#include "kernels.h"

/* Angle of each front wheel as if it could turn to any side. */
void ackermann_inverse(const ackermann_car_twist *twist, const ackermann_car_wheels *now, ackermann_car_wheels *out)
{
    (void)now;
    const float w = 0.75f * twist->omega, y = 2.5f * twist->omega;
    const float left = twist->vx - w, right = twist->vx + w;
    out->rear_left.spin = 3.33333333f * left;
    out->rear_right.spin = 3.33333333f * right;
    out->front_left.steer = direction(y, left);
    out->front_right.steer = direction(y, right);
}

/* The angle within +-40 degrees at which the wheel slides least: the slope of (x, y) is cut at tan 40 degrees, so the
 * arctangent needs no quadrants. A wheel that stands holds its angle. */
INLINE float limited(float x, float y, float present)
{
    float q = y / (fabsf(x) < 1e-20f ? 1e-20f : x);
    q = q < 0.839099631f ? q : 0.839099631f;
    q = q > -0.839099631f ? q : -0.839099631f;
    if (fabsf(x) + fabsf(y) < 2e-20f) {
        const float held = present < 0.698131701f ? present : 0.698131701f;
        return held > -0.698131701f ? held : -0.698131701f;
    }
    return slope_angle(q);
}

/* With limits and the nearest branch. */
void ackermann_inverse_limited(const ackermann_car_twist *twist, const ackermann_car_wheels *now, ackermann_car_wheels *out)
{
    const float w = 0.75f * twist->omega, y = 2.5f * twist->omega;
    const float left = twist->vx - w, right = twist->vx + w;
    out->rear_left.spin = 3.33333333f * left;
    out->rear_right.spin = 3.33333333f * right;
    out->front_left.steer = limited(left, y, now->front_left.steer);
    out->front_right.steer = limited(right, y, now->front_right.steer);
}

/* Least squares over two rolling and four sliding rows, as wmrgen poses it, with the 3 x 3 inverse written out. The
 * determinant is at least 4.5; it is kept above 1 (in wmrgen's C above 2.25), so that a reader and an analyser see no
 * division by zero. */
void ackermann_forward(const ackermann_car_wheels *wheels, ackermann_car_twist *out)
{
    float c, s, d, t;
    turn(wheels->front_left.steer, &c, &s);
    turn(wheels->front_right.steer, &d, &t);
    const float g = MADD(0.75f, s, 2.5f * c), h = MADD(2.5f, d, -0.75f * t);
    const float yy = MADD(c, c, MADD(d, d, 2.0f)), ww = MADD(g, g, MADD(h, h, 1.125f)), yw = MADD(c, g, d * h);
    const float xy = MADD(c, s, d * t), xw = MADD(s, g, t * h), xx = 6.0f - yy;
    const float p = MADD(yy, ww, -(yw * yw)), q = MADD(ww, xy, -(yw * xw)), r = MADD(yy, xw, -(yw * xy));
    const float a = 0.3f * (wheels->rear_left.spin + wheels->rear_right.spin);
    const float b = 0.225f * (wheels->rear_right.spin - wheels->rear_left.spin);
    const float det = MADD(xx, p, -MADD(xy, q, xw * r)), k = 1.0f / (det < 1.0f ? 1.0f : det);
    out->vx = k * MADD(a, p, b * r);
    out->vy = k * MADD(a, q, b * MADD(xy, xw, -(yw * xx)));
    out->omega = k * MADD(a, r, b * MADD(yy, xx, -(xy * xy)));
}
