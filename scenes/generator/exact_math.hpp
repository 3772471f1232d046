// Elementary functions that give the same bits on every machine. Those of the C library do not: their last
// bit differs between versions. Here are only + - * / and square roots, which IEEE 754 rounds correctly, in a
// fixed order (the project is compiled with -ffp-contract=off).
// Errors are a few units in the last place of a double.
#pragma once

namespace kiloband::generator {

inline constexpr double kPi = 3.141592653589793;

/// x in radians, |x| < 1e5.
double sine(double x);
double cosine(double x);
/// Angle of the point (x, y) in (-pi, pi]; 0 for the origin.
double arctangent(double y, double x);
/// |x| < 700
double exponential(double x);
/// x > 0
double logarithm(double x);
/// base >= 0; 0 to any power is 0.
double power(double base, double exponent);

/// Hermite step from 0 at x <= a to 1 at x >= b.
double smooth_step(double a, double b, double x);
double mix(double a, double b, double t);
double clamp(double x, double low, double high);

/// In [0, 1), from the bits of a seed and a counter (the finalizer of MurmurHash3 over both).
double random_number(unsigned seed, unsigned counter);

}  // namespace kiloband::generator
