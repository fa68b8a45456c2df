/* Four mecanum wheels in X, radius 0.05 m, half-wheelbase + half-track 0.4954 m. */
#include "clearpath_do100.h"
#include "kernels.h"

void mecanum_inverse(const clearpath_do100_twist *twist, clearpath_do100_wheels *out)
{
    const float a = 20.0f * twist->vx, b = 20.0f * twist->vy, c = 9.908f * twist->omega;
    const float difference = a - b, sum = a + b;
    out->front_left.spin = difference - c;
    out->front_right.spin = sum + c;
    out->rear_left.spin = sum - c;
    out->rear_right.spin = difference + c;
}

void mecanum_forward(const clearpath_do100_wheels *wheels, clearpath_do100_twist *out)
{
    const float front = wheels->front_left.spin + wheels->front_right.spin, rear = wheels->rear_left.spin + wheels->rear_right.spin;
    const float p = wheels->front_right.spin - wheels->front_left.spin, q = wheels->rear_right.spin - wheels->rear_left.spin;
    out->vx = 0.0125f * (front + rear);
    out->vy = 0.0125f * (p - q);
    out->omega = 0.0252321356f * (p + q);
}
