/* Four mecanum wheels in X, radius 0.05 m, half-wheelbase + half-track 0.4954 m. */
#include "clearpath_do100.h"
#include "kernels.h"

void mecanum_inverse(const clearpath_do100_inverse_in *in, clearpath_do100_inverse_out *out)
{
    const float a = 20.0f * in->vx, b = 20.0f * in->vy, c = 9.908f * in->omega;
    const float difference = a - b, sum = a + b;
    out->front_left.spin = difference - c;
    out->front_right.spin = sum + c;
    out->rear_left.spin = sum - c;
    out->rear_right.spin = difference + c;
}

void mecanum_forward(const clearpath_do100_forward_in *in, clearpath_do100_forward_out *out)
{
    const float front = in->front_left.spin + in->front_right.spin, rear = in->rear_left.spin + in->rear_right.spin;
    const float p = in->front_right.spin - in->front_left.spin, q = in->rear_right.spin - in->rear_left.spin;
    out->vx = 0.0125f * (front + rear);
    out->vy = 0.0125f * (p - q);
    out->omega = 0.0252321356f * (p + q);
}
