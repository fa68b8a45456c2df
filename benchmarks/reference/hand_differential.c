/* Differential drive: wheel radius 0.1 m, half-track 0.6 m. */
#include "textbook_differential.h"
#include "kernels.h"

void differential_inverse(const textbook_differential_inverse_in *in, textbook_differential_inverse_out *out)
{
    const float a = 10.0f * in->vx, b = 6.0f * in->omega;
    out->right.spin = a + b;
    out->left.spin = a - b;
}

void differential_forward(const textbook_differential_forward_in *in, textbook_differential_forward_out *out)
{
    out->vx = 0.05f * (in->right.spin + in->left.spin);
    out->vy = 0.0f;
    out->omega = 0.0833333333f * (in->right.spin - in->left.spin);
}
