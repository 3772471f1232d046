#include "sky/sun_position.hpp"

#include <chrono>
#include <cmath>

#include "sky/clear_sky.hpp"

namespace kiloband {
namespace {

/// Days since noon of 1 January 2000, UTC.
double days_since_2000(const PlaceAndTime& at, double hours_utc) {
  using namespace std::chrono;
  const auto date =
      sys_days(year(at.year) / month(static_cast<unsigned>(at.month)) / day(static_cast<unsigned>(at.day)));
  const auto begin = sys_days(year(2000) / 1 / 1);
  return static_cast<double>((date - begin).count()) + (hours_utc - 12) / 24;
}

}  // namespace

SunPosition sun_position(const PlaceAndTime& at) {
  const double hours = at.hour + at.minute / 60 + at.second / 3600 - at.timezone_h;
  const double n = days_since_2000(at, hours);
  // Ecliptic coordinates, rad.
  const double omega = 2.1429 - 0.0010394594 * n;
  const double mean_longitude = 4.8950630 + 0.017202791698 * n;
  const double anomaly = 6.2400600 + 0.0172019699 * n;
  const double longitude = mean_longitude + 0.03341607 * std::sin(anomaly) +
                           0.00034894 * std::sin(2 * anomaly) - 0.0001134 - 0.0000203 * std::sin(omega);
  const double obliquity = 0.4090928 - 6.2140e-9 * n + 0.0000396 * std::cos(omega);
  const double ascension = std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
  const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));
  // Of the place.
  const double sidereal_h = 6.6974243242 + 0.0657098283 * n + hours;
  const double hour_angle = (15 * sidereal_h + at.longitude_deg) * kDegree - ascension;
  const double latitude = at.latitude_deg * kDegree;
  double zenith = std::acos(std::cos(latitude) * std::cos(hour_angle) * std::cos(declination) +
                            std::sin(declination) * std::sin(latitude));
  zenith += 6371.01 / 149597890.0 * std::sin(zenith);  // seen from the ground, not from the earth's centre
  const double azimuth = std::atan2(-std::sin(hour_angle), std::tan(declination) * std::cos(latitude) -
                                                               std::sin(latitude) * std::cos(hour_angle));
  return {90 - zenith / kDegree, std::fmod(azimuth / kDegree + 360, 360)};
}

}  // namespace kiloband
