/* What generated C and hand-written references take from <math.h>, for objects without a C library. */
#ifndef WMRGEN_EMULATOR_MATH_H
#define WMRGEN_EMULATOR_MATH_H

float sinf(float x);
float cosf(float x);
float atanf(float x);
float atan2f(float y, float x);
float sqrtf(float x);
float fabsf(float x);
float fmaf(float x, float y, float z);
float copysignf(float x, float y);
double sin(double x);
double cos(double x);
double atan(double x);
double atan2(double y, double x);
double sqrt(double x);
double fabs(double x);
double fma(double x, double y, double z);

#endif
