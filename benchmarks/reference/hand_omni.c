/* Three omni wheels at 120 degrees, radius 0.05 m, 0.125 m from P. */
#include "lekiwi.h"
#include "kernels.h"

void omni_inverse(const lekiwi_twist *twist, lekiwi_wheels *out)
{
    const float w = 2.5f * twist->omega, y = 10.0f * twist->vy, x = 17.3205081f * twist->vx;
    const float a = w + y;
    out->left_wheel.spin = a - x;
    out->back_wheel.spin = w - (y + y);
    out->right_wheel.spin = a + x;
}

void omni_forward(const lekiwi_wheels *wheels, lekiwi_twist *out)
{
    const float left = wheels->left_wheel.spin, back = wheels->back_wheel.spin, right = wheels->right_wheel.spin;
    const float sides = left + right;
    out->vx = 0.0288675135f * (right - left);
    out->vy = 0.0166666667f * (sides - (back + back));
    out->omega = 0.133333333f * (sides + back);
}
