"""Brightness temperatures of a scene in the thermal infrared."""
import math
import unittest

from rendered_page import RenderedPage

SIZE = 32  # so that pixels are too small on the screen for numbers over their colours
BLACK_K = 350
# Left a grey plate that reflects a colder hemisphere, right a black body.
SCENE = f"""<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="orthographic">
    <transform name="to_world"><lookat origin="0, 0, 2" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="bandfilm">
      <integer name="width" value="{SIZE}"/> <integer name="height" value="{SIZE}"/>
      <string name="bands" value="8000-9000, 11000-12000"/> <rfilter type="box"/>
    </film>
  </sensor>
  <shape type="rectangle">
    <transform name="to_world"><scale x="0.5"/><translate x="-0.5"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="8000:0.2, 12000:0.6"/></bsdf>
    <emitter type="thermal"><float name="temperature" value="450"/></emitter>
  </shape>
  <shape type="rectangle">
    <transform name="to_world"><scale x="0.5"/><translate x="0.5"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf>
    <emitter type="thermal"><float name="temperature" value="{BLACK_K}"/></emitter>
  </shape>
  <emitter type="thermal"><float name="temperature" value="280"/></emitter>
</scene>
"""
H, C, K = 6.62607015e-34, 299792458.0, 1.380649e-23  # SI, exact


def planck(low_nm, high_nm, temperature_k, steps=400):
    """Planck's law over a channel, W m-2 sr-1: Simpson's rule."""
    width_m = (high_nm - low_nm) * 1e-9 / steps
    total = 0.0
    for i in range(steps + 1):
        wavelength_m = low_nm * 1e-9 + i * width_m
        radiance = 2 * H * C**2 / wavelength_m**5 / math.expm1(H * C / (wavelength_m * K * temperature_k))
        total += radiance * (1 if i in (0, steps) else 4 if i % 2 else 2)
    return total * width_m / 3


def brightness_temperature(low_nm, high_nm, radiance):
    low, high = 100.0, 1000.0
    while high - low > 1e-4:
        middle = (low + high) / 2
        low, high = (middle, high) if planck(low_nm, high_nm, middle) < radiance else (low, middle)
    return (low + high) / 2


class Thermal(RenderedPage):
    @classmethod
    def scene(cls):
        file = cls.saved / "plates.xml"
        file.write_text(SCENE)
        return (file,)

    def row_of_temperatures(self, y):
        return self.browser.value(
            """const {get_json} = await import('/api.js');
            const {frame_parameters} = await import('/state.js');
            return (await get_json('/api/values', {...frame_parameters(), ...given})).values;""", {"x0": 0, "y0": y, "x1": SIZE - 1, "y1": y})

    def test_temperatures_are_the_cube_s(self):
        self.wait_for_samples(64)
        self.pause()
        cube = self.save("plates")
        self.open_tab("image")
        self.assertEqual(self.browser.value("return state.view.mode"), "temperature")  # by itself, where there is no colour
        for channel, key in [(1, "]"), (0, "[")]:
            self.browser.press(key)
            self.browser.wait("return state.frame.parameters.channel === given && state.frame.parameters.quality === 'exact'",
                              "the channel's exact frame", str(channel))
            shown = self.row_of_temperatures(5)
            low_nm, high_nm = cube.low[channel], cube.high[channel]
            for x in range(SIZE):
                true = brightness_temperature(low_nm, high_nm, cube.at(x, 5, channel) * (high_nm - low_nm))
                self.assertAlmostEqual(shown[x], true, delta=1e-4 * true + 2e-3)
            self.assertAlmostEqual(shown[SIZE - 3], BLACK_K, delta=0.5)
            self.assertGreater(shown[2], BLACK_K + 10)
            self.assert_painted(shown, 5)

    def assert_painted(self, shown, y):
        """Colours of the map between the bar's ends, which are in kelvins."""
        low, high, colours = self.browser.value(
            """const {get_json} = await import('/api.js');
            const {colors} = await get_json('/api/colormap', {map: state.view.map});
            return [state.frame.low, state.frame.high, colors];""")
        self.assertRegex(self.browser.find("#colorbar").get_attribute("aria-label"), r", K$")
        for x in (2, SIZE - 3):
            place = min(1, max(0, (shown[x] - low) / (high - low)))
            near = colours[max(0, math.floor(255 * place) - 1):math.ceil(255 * place) + 2]
            painted = "#" + "".join(f"{part:02x}" for part in self.browser.colour_at(x, y))
            self.assertIn(painted, [colour.lower() for colour in near])


if __name__ == "__main__":
    unittest.main()
