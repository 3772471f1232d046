// Coefficients of the band model beyond 4 um, for the band functions of SPCTRAL2 (docs/sky_model.md). From 4 to 14 um they
// were fitted by this project to the transmission of the lowest kilometre of MODTRAN 5's mid-latitude summer atmosphere
// (pyBSM atmosphere database); the rest are rounded figures of the CO2 band at 15 um and of the rotational band of water
// vapour, which is opaque anyhow. Ozone: the band at 9.6 um, about half transparent at the zenith.
#pragma once

namespace kiloband {

struct InfraredRow {
  double lambda_nm;
  double water;  // cm^-1 of precipitable water; lines only, without the continuum
  double mixed;  // per air mass: CO2, N2O, CH4
  double ozone;  // (atm cm)^-1
};

// clang-format off
inline constexpr InfraredRow kInfrared[] = {
    {4000, 0.1, 0.6, 0},
    {4250, 0.1, 530, 0},
    {4500, 0.5, 190, 0},
    {4750, 8, 10, 0.05},
    {5000, 130, 0, 0},
    {5250, 960, 0, 0},
    {5500, 4300, 0, 0},
    {5750, 11500, 0, 0},
    {6000, 20000, 0, 0},
    {6750, 20000, 0, 0},
    {7000, 11500, 0, 0},
    {7250, 5400, 0, 0},
    {7500, 1000, 20, 0},
    {7750, 200, 20, 0},
    {8000, 55, 1.5, 0},
    {8250, 15, 0, 0},
    {8500, 6, 0, 0},
    {8750, 1.6, 0, 0},
    {9000, 1.1, 0, 0.3},
    {9250, 0.3, 0, 1},
    {9500, 0.3, 0.1, 2.2},
    {9750, 0.2, 0, 2},
    {10000, 0.1, 0, 0.7},
    {10250, 0.1, 0, 0.15},
    {10500, 0.15, 0, 0},
    {11000, 0.18, 0, 0},
    {11500, 0.25, 0, 0},
    {11750, 1.2, 0, 0},
    {12000, 0.5, 0, 0},
    {12250, 0.5, 0, 0},
    {12500, 6, 20, 0},
    {12750, 3, 2, 0},
    {13000, 3, 2, 0},
    {13250, 6, 35, 0},
    {13500, 8, 180, 0},
    {13750, 10, 170, 0.5},
    {14000, 15, 650, 0.5},
    {14250, 18, 2000, 0},
    {14500, 20, 8000, 0},
    {14750, 25, 20000, 0},
    {15250, 30, 20000, 0},
    {15500, 35, 6000, 0},
    {15750, 40, 2500, 0},
    {16000, 45, 1500, 0},
    {16500, 60, 250, 0},
    {17000, 90, 60, 0},
    {17500, 110, 10, 0},
    {18000, 130, 2, 0},
    {19000, 200, 0.3, 0},
    {20000, 300, 0, 0},
    {22000, 600, 0, 0},
    {25000, 1500, 0, 0},
    {30000, 4000, 0, 0},
    {40000, 10000, 0, 0},
    {100000, 10000, 0, 0},
};
// clang-format on

}  // namespace kiloband
