/* Defines what the CUDA compiler knows by itself, so that g++ can compile scalar CUDA code. */
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>

#define __host__
#define __device__
#define __global__
#define __constant__ static const
#define __forceinline__ inline
#define __noinline__ __attribute__((noinline))
#define __restrict__ __restrict

inline float rsqrtf(float x) { return 1.0f / sqrtf(x); }
inline double rsqrt(double x) { return 1.0 / sqrt(x); }
inline float rsqrt(float x) { return rsqrtf(x); }
inline float __saturatef(float x) { return fminf(fmaxf(x, 0.0f), 1.0f); }
inline float fdividef(float x, float y) { return x / y; }

struct float3 { float x, y, z; };
struct double3 { double x, y, z; };

using std::max;
using std::min;
