// Lets a C++ compiler compile scalar OSL code: `float` becomes a class that computes as OSL does.
// In OSL no arithmetic results in inf or nan: where C would, the result is 0 or is clamped.
#pragma once

#include <cfloat>
#include <cmath>
#include <cstdio>

namespace shadefit {

class real {
public:
    real() = default;
    constexpr real(int x) : v(float(x)) {}
    constexpr real(float x) : v(x) {}
    constexpr explicit real(double x) : v(float(x)) {}
    constexpr explicit operator double() const { return v; }
    constexpr explicit operator int() const { return int(v); }
    float v;
};

inline real operator+(real x, real y) { return x.v + y.v; }
inline real operator-(real x, real y) { return x.v - y.v; }
inline real operator*(real x, real y) { return x.v * y.v; }
inline real operator/(real x, real y) { return y.v == 0 ? 0 : x.v / y.v; }
inline real operator-(real x) { return -x.v; }
inline real operator+(real x) { return x; }
inline real& operator+=(real& x, real y) { return x = x + y; }
inline real& operator-=(real& x, real y) { return x = x - y; }
inline real& operator*=(real& x, real y) { return x = x * y; }
inline real& operator/=(real& x, real y) { return x = x / y; }
inline int operator<(real x, real y) { return x.v < y.v; }
inline int operator>(real x, real y) { return x.v > y.v; }
inline int operator<=(real x, real y) { return x.v <= y.v; }
inline int operator>=(real x, real y) { return x.v >= y.v; }
inline int operator==(real x, real y) { return x.v == y.v; }
inline int operator!=(real x, real y) { return x.v != y.v; }

inline real max(real x, real y) { return x.v > y.v ? x : y; }
inline real min(real x, real y) { return x.v < y.v ? x : y; }
inline real clamp(real x, real low, real high) { return min(max(x, low), high); }
inline real mix(real x, real y, real a) { return x * (1 - a) + y * a; }
inline real select(real no, real yes, real which) { return which.v != 0 ? yes : no; }
inline real step(real edge, real x) { return x.v < edge.v ? 0 : 1; }
inline real sign(real x) { return (x.v > 0) - (x.v < 0); }
inline real abs(real x) { return std::fabs(x.v); }
inline real fabs(real x) { return std::fabs(x.v); }
inline real fmod(real x, real y) { return y.v == 0 ? 0 : std::fmod(x.v, y.v); }
inline real mod(real x, real y) { return y.v == 0 ? 0 : x.v - y.v * std::floor(x.v / y.v); }
inline real floor(real x) { return std::floor(x.v); }
inline real ceil(real x) { return std::ceil(x.v); }
inline real round(real x) { return std::round(x.v); }
inline real trunc(real x) { return std::trunc(x.v); }

inline real sqrt(real x) { return x.v <= 0 ? 0.0f : std::sqrt(x.v); }
inline real inversesqrt(real x) { return x.v <= 0 ? 0.0f : 1.0f / std::sqrt(x.v); }
inline real cbrt(real x) { return std::cbrt(x.v); }
inline real hypot(real x, real y) { return std::sqrt(x.v * x.v + y.v * y.v); }
inline real exp(real x) { return std::fmin(std::exp(x.v), FLT_MAX); }
inline real exp2(real x) { return std::fmin(std::exp2(x.v), FLT_MAX); }
inline real expm1(real x) { return std::fmin(std::expm1(x.v), FLT_MAX); }
inline real log(real x) { return std::log(std::fmax(x.v, FLT_MIN)); }
inline real log2(real x) { return std::log2(std::fmax(x.v, FLT_MIN)); }
inline real log10(real x) { return std::log10(std::fmax(x.v, FLT_MIN)); }
inline real pow(real x, real y) {
    if (y.v == 0) return 1;
    if (x.v == 0 || (x.v < 0 && y.v != std::floor(y.v))) return 0;
    return std::fmin(std::fmax(std::pow(x.v, y.v), -FLT_MAX), FLT_MAX);
}
inline real sin(real x) { return std::sin(x.v); }
inline real cos(real x) { return std::cos(x.v); }
inline real tan(real x) { return std::tan(x.v); }
inline real asin(real x) { return std::asin(clamp(x, -1, 1).v); }
inline real acos(real x) { return std::acos(clamp(x, -1, 1).v); }
inline real atan(real x) { return std::atan(x.v); }
inline real atan2(real y, real x) { return std::atan2(y.v, x.v); }
inline real sinh(real x) { return std::sinh(x.v); }
inline real cosh(real x) { return std::cosh(x.v); }
inline real tanh(real x) { return std::tanh(x.v); }
inline real erf(real x) { return std::erf(x.v); }

struct triple {
    real part[3];
    real& operator[](int index) { return part[index]; }
    const real& operator[](int index) const { return part[index]; }
};

}  // namespace shadefit

// All output arguments here are arrays, which C++ passes by address anyway.
#define output
#define float shadefit::real
#define vector shadefit::triple
