// Optical constants of metals: Lorentz-Drude parameters, and measured tables beyond the models' ranges.
#pragma once

#include <span>
#include <string_view>

#include "spectral/materials/lorentz_drude.hpp"

namespace kiloband {

/// Wavelength in um, n, k.
struct TabulatedIndex {
  double lambda_um, n, k;
};

/// Silver, template-stripped. Yang et al., Phys. Rev. B 91, 235137 (2015), supplement.
inline constexpr TabulatedIndex kAgFar[] = {
    {12.46, 15.12, 84.67}, {12.71, 15.67, 86.18}, {12.96, 16.25, 87.74}, {13.23, 16.87, 89.36},
    {13.5, 17.52, 91.03},  {13.79, 18.2, 92.77},  {14.09, 18.93, 94.57}, {14.4, 19.7, 96.43},
    {14.73, 20.51, 98.37}, {15.07, 21.37, 100.4}, {15.43, 22.29, 102.5}, {15.81, 23.27, 104.6},
    {16.2, 24.31, 106.9},  {16.62, 25.41, 109.3}, {17.05, 26.59, 111.7}, {17.51, 27.85, 114.3},
    {18, 29.2, 116.9},     {18.52, 30.65, 119.7}, {19.06, 32.2, 122.6},  {19.64, 33.86, 125.6},
    {20.25, 35.65, 128.8}};

/// Gold. Ordal et al., Appl. Opt. 26, 744 (1987).
inline constexpr TabulatedIndex kAuFar[] = {{6.67, 6.03, 47.4}, {8, 8.29, 56.2},    {10, 12.1, 69.2},
                                            {11.1, 14.7, 76.3}, {12.5, 18.2, 84.7}, {14.3, 23, 94.9},
                                            {16.7, 29.8, 108},  {20, 39.9, 124},    {22.2, 46.8, 133}};

/// Copper. Ordal et al., Appl. Opt. 24, 4493 (1985) and 22, 1099 (1983).
inline constexpr TabulatedIndex kCuFar[] = {{12.5, 11.4, 76.5}, {13.3, 12.2, 80.8}, {14.3, 13.2, 85.6},
                                            {15.4, 13.8, 91.1}, {16.7, 14.7, 97.7}, {18.2, 15.4, 105},
                                            {20, 16.2, 115},    {20.8, 16.8, 120}};

/// Nickel. Ordal et al., Appl. Opt. 26, 744 (1987).
inline constexpr TabulatedIndex kNiFar[] = {{6.67, 6.05, 24.4}, {8, 7.12, 29},    {10, 8.42, 35.7},
                                            {11.1, 9.55, 39.5}, {12.5, 11, 43.8}, {14.3, 13, 49},
                                            {16.7, 15.2, 55.5}, {20, 18.1, 64.6}, {22.2, 20, 70.7}};

/// Tungsten. Ordal et al., Appl. Opt. 27, 1203 (1988).
inline constexpr TabulatedIndex kWFar[] = {{12.5, 12.935818, 53.112521},
                                           {14.3, 15.634532, 59.208636},
                                           {16.7, 19.231714, 66.923752},
                                           {20, 24.256111, 77.087223},
                                           {22.2, 27.599188, 83.517367}};

/// The model's range is in eV, as published; `far` continues it towards longer wavelengths.
struct MetalEntry {
  std::string_view name, substance;
  double min_ev, max_ev;
  LorentzDrude model;
  std::span<const TabulatedIndex> far;
  std::string_view source;
};

#define KB_RAKIC "Lorentz-Drude model, Rakic et al., Appl. Opt. 37, 5271 (1998)"

/// Parameters: Rakic et al. 1998, table 1 (plasma energies), tables 2 and 3 (Lorentz-Drude).
inline constexpr MetalEntry kMetals[] = {
    {"Ag",
     "silver",
     0.1,
     5,
     {9.01,
      0.845,
      0.048,
      {{0.065, 0.816, 3.886},
       {0.124, 4.481, 0.452},
       {0.011, 8.185, 0.065},
       {0.84, 9.083, 0.916},
       {5.646, 20.29, 2.419}}},
     kAgFar,
     KB_RAKIC "; beyond, Yang et al., Phys. Rev. B 91, 235137 (2015)"},
    {"Al",
     "aluminium",
     0.005,
     20,
     {14.98,
      0.523,
      0.047,
      {{0.227, 0.162, 0.333}, {0.05, 1.544, 0.312}, {0.166, 1.808, 1.351}, {0.03, 3.473, 3.382}}},
     {},
     KB_RAKIC},
    {"Au",
     "gold",
     0.2,
     5,
     {9.03,
      0.76,
      0.053,
      {{0.024, 0.415, 0.241},
       {0.01, 0.83, 0.345},
       {0.071, 2.969, 0.87},
       {0.601, 4.304, 2.494},
       {4.384, 13.32, 2.214}}},
     kAuFar,
     KB_RAKIC "; beyond, Ordal et al., Appl. Opt. 26, 744 (1987)"},
    {"Be",
     "beryllium",
     0.02,
     5,
     {18.51,
      0.084,
      0.035,
      {{0.031, 0.1, 1.664}, {0.14, 1.032, 3.395}, {0.53, 3.183, 4.454}, {0.13, 4.604, 1.802}}},
     {},
     KB_RAKIC},
    {"Cr",
     "chromium",
     0.02,
     5,
     {10.75,
      0.168,
      0.047,
      {{0.151, 0.121, 3.175}, {0.15, 0.543, 1.305}, {1.149, 1.97, 2.676}, {0.825, 8.775, 1.335}}},
     {},
     KB_RAKIC},
    {"Cu",
     "copper",
     0.1,
     6,
     {10.83,
      0.575,
      0.03,
      {{0.061, 0.291, 0.378}, {0.104, 2.957, 1.056}, {0.723, 5.3, 3.213}, {0.638, 11.18, 4.305}}},
     kCuFar,
     KB_RAKIC "; beyond, Ordal et al., Appl. Opt. 24, 4493 (1985)"},
    {"Ni",
     "nickel",
     0.2,
     5,
     {15.92,
      0.096,
      0.048,
      {{0.1, 0.174, 4.511}, {0.135, 0.582, 1.334}, {0.106, 1.597, 2.178}, {0.729, 6.089, 6.292}}},
     kNiFar,
     KB_RAKIC "; beyond, Ordal et al., Appl. Opt. 26, 744 (1987)"},
    {"Pd",
     "palladium",
     0.1,
     5,
     {9.72,
      0.33,
      0.008,
      {{0.649, 0.336, 2.95}, {0.121, 0.501, 0.555}, {0.638, 1.659, 4.621}, {0.453, 5.715, 3.236}}},
     {},
     KB_RAKIC},
    {"Pt",
     "platinum",
     0.1,
     5,
     {9.59,
      0.333,
      0.08,
      {{0.191, 0.78, 0.517}, {0.659, 1.314, 1.838}, {0.547, 3.141, 3.668}, {3.576, 9.249, 8.517}}},
     {},
     KB_RAKIC},
    {"Ti",
     "titanium",
     0.04,
     5,
     {7.29,
      0.148,
      0.082,
      {{0.899, 0.777, 2.276}, {0.393, 1.545, 2.518}, {0.187, 2.509, 1.663}, {0.001, 19.43, 1.762}}},
     {},
     KB_RAKIC},
    {"W",
     "tungsten",
     0.1,
     5,
     {13.22,
      0.206,
      0.064,
      {{0.054, 1.004, 0.53}, {0.166, 1.917, 1.281}, {0.706, 3.58, 3.332}, {2.59, 7.498, 5.836}}},
     kWFar,
     KB_RAKIC "; beyond, Ordal et al., Appl. Opt. 27, 1203 (1988)"},
};

#undef KB_RAKIC

}  // namespace kiloband
