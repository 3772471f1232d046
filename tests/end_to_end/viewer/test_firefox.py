"""What a user does most, in Firefox: tests of Chromium's, by name."""
import unittest

import test_camera
import test_render
import test_stored_cube
from firefox import Firefox


class Render(test_render.Render):
    browser_type = Firefox


class Camera(test_camera.Camera):
    browser_type = Firefox


class StoredCube(test_stored_cube.StoredCube):
    browser_type = Firefox


CORE = [
    Render("test_refines"), Render("test_the_plot_holds_what_is_saved"), Render("test_modes_do_not_restart"),
    Render("test_orbit_restarts_and_reset_returns"), Render("test_keys_fly"), Camera("test_the_wheel_dollies"),
    StoredCube("test_a_click_plots_the_pixel_of_the_file"), StoredCube("test_the_keyboard_pins_and_unpins"),
    StoredCube("test_csv_has_the_curves"),
]  # fmt: skip


def load_tests(*_):
    return unittest.TestSuite(CORE)


if __name__ == "__main__":
    unittest.main()
