/* Differential drive: wheel radius 0.1 m, half-track 0.6 m. */
#include "textbook_differential.h"
#include "kernels.h"

void differential_inverse(const textbook_differential_twist *twist, textbook_differential_wheels *out)
{
    const float a = 10.0f * twist->vx, b = 6.0f * twist->omega;
    out->right.spin = a + b;
    out->left.spin = a - b;
}

void differential_forward(const textbook_differential_wheels *wheels, textbook_differential_twist *out)
{
    out->vx = 0.05f * (wheels->right.spin + wheels->left.spin);
    out->vy = 0.0f;
    out->omega = 0.0833333333f * (wheels->right.spin - wheels->left.spin);
}
