/* Four swerve modules on a square of half-side 0.381 m, radius 0.0508 m. */
#include "wpilib_swervebot.h"
#include "steer.h"

/* As most swerve code: direction and speed of each module, speed never negative. */
void swerve4_inverse(const wpilib_swervebot_twist *twist, const wpilib_swervebot_wheels *now, wpilib_swervebot_wheels *out)
{
    (void)now;
    const float w = 0.381f * twist->omega;
    const float left = twist->vx - w, right = twist->vx + w, front = twist->vy + w, back = twist->vy - w;
    const float left2 = left * left, right2 = right * right;
    out->front_left.steer = direction(front, left);
    out->front_left.spin = 19.6850394f * sqrtf(MADD(front, front, left2));
    out->front_right.steer = direction(front, right);
    out->front_right.spin = 19.6850394f * sqrtf(MADD(front, front, right2));
    out->back_left.steer = direction(back, left);
    out->back_left.spin = 19.6850394f * sqrtf(MADD(back, back, left2));
    out->back_right.steer = direction(back, right);
    out->back_right.spin = 19.6850394f * sqrtf(MADD(back, back, right2));
}

/* The branch nearest the present angle, held at standstill. */
void swerve4_inverse_nearest(const wpilib_swervebot_twist *twist, const wpilib_swervebot_wheels *now, wpilib_swervebot_wheels *out)
{
    const float w = 0.381f * twist->omega;
    const float left = twist->vx - w, right = twist->vx + w, front = twist->vy + w, back = twist->vy - w;
    out->front_left.spin = steer(left, front, 19.6850394f, now->front_left.steer, &out->front_left.steer);
    out->front_right.spin = steer(right, front, 19.6850394f, now->front_right.steer, &out->front_right.steer);
    out->back_left.spin = steer(left, back, 19.6850394f, now->back_left.steer, &out->back_left.steer);
    out->back_right.spin = steer(right, back, 19.6850394f, now->back_right.steer, &out->back_right.steer);
}

/* Least squares: rows of one module are a rotation of [1 0 -y; 0 1 x], so the normal matrix is constant. */
void swerve4_forward(const wpilib_swervebot_wheels *wheels, wpilib_swervebot_twist *out)
{
    float ax, ay, bx, by, cx, cy, dx, dy;
    polar(wheels->front_left.spin, wheels->front_left.steer, &ax, &ay);
    polar(wheels->front_right.spin, wheels->front_right.steer, &bx, &by);
    polar(wheels->back_left.spin, wheels->back_left.steer, &cx, &cy);
    polar(wheels->back_right.spin, wheels->back_right.steer, &dx, &dy);
    const float left = ax + cx, right = bx + dx, front = ay + by, back = cy + dy;
    out->vx = 0.0127f * (left + right);
    out->vy = 0.0127f * (front + back);
    out->omega = 0.0166666667f * ((right - left) + (front - back));
}
