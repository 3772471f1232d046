// Where the sun stands, by place and time.
#pragma once

namespace kiloband {

/// Of a place, by the clock there.
struct PlaceAndTime {
  double latitude_deg = 0;   // north > 0
  double longitude_deg = 0;  // east > 0
  double timezone_h = 0;     // what the clock is ahead of UTC
  int year = 2000, month = 1, day = 1;
  double hour = 12, minute = 0, second = 0;
};

struct SunPosition {
  double elevation_deg;  // above the horizon, without refraction
  double azimuth_deg;    // from north towards east, 0 to 360
};

/// Source: M. Blanco-Muriel et al., "Computing the solar vector", Solar Energy 70 (2001): within 0.01 degrees from 1999
/// to 2015, 0.03 degrees some decades away.
SunPosition sun_position(const PlaceAndTime& at);

}  // namespace kiloband
