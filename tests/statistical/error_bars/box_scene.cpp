#include "box_scene.hpp"

namespace kiloband::test {

std::string box_sensor(const std::string& film_text) {
  return object("sensor", "perspective",
                real("fov", 39) + text("fov_axis", "larger") + to_world(lookat("0, 0, 3.8", "0, 0, 0")) +
                    film(film_text));
}

std::string box_walls() {
  const std::string white = diffuse("400:0.6, 480:0.75, 600:0.72, 780:0.8");
  const std::string red = diffuse("400:0.05, 560:0.06, 620:0.6, 780:0.7");
  const std::string green = diffuse("400:0.1, 480:0.15, 530:0.5, 580:0.2, 780:0.15");
  return rectangle(turn("x", -90) + translate(0, -1, 0), white) +
         rectangle(turn("x", 90) + translate(0, 1, 0), white) + rectangle(translate(0, 0, -1), white) +
         rectangle(turn("y", 90) + translate(-1, 0, 0), red) +
         rectangle(turn("y", -90) + translate(1, 0, 0), green);
}

std::string box_light(const std::string& radiance) {
  return rectangle(scale("0.4") + turn("x", 90) + translate(0, 0.99, 0),
                   diffuse("400:0.7, 780:0.78") + lamp(radiance));
}

std::string box_block() {
  return shape("cube", scale(0.3, 0.6, 0.3) + turn("y", 20) + translate(-0.3, -0.4, -0.3),
               diffuse("400:0.6, 480:0.75, 780:0.8"));
}

std::string comb(double first_nm, double last_nm, double period_nm, double low, double high) {
  std::string points;
  const int periods = static_cast<int>((last_nm - first_nm) / period_nm + 0.5);
  for (int i = 0; i <= 2 * periods; ++i)
    points +=
        (i > 0 ? ", " : "") + exact(first_nm + 0.5 * period_nm * i) + ":" + exact(i % 2 == 0 ? low : high);
  return points;
}

}  // namespace kiloband::test
