// Units that files state for their values.
#include <gtest/gtest.h>

#include "spectral/files/spectrum_files.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/files/value_units.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

struct Reading {
  Spectrum spectrum;
  std::vector<std::string> messages;
};

Reading read(const std::string& content, ValueKind kind) {
  const TemporaryFolder folder;
  Reading result;
  const auto file = folder.write("f.csv", content);
  result.spectrum = read_spectrum_file(file, kind, [&](const Diagnostic& d) {
    result.messages.push_back((d.severity == Severity::kWarning ? "warning: " : "note: ") + d.message);
  });
  return result;
}

TEST(ValueUnits, OfPower) {
  struct Case {
    const char* text;
    double factor;
    bool area, angle, wavenumber;
  };
  const Case cases[] = {
      {"E-490 W/m2/micron", 1e-3, true, false, false},
      {"Etr W*m-2*nm-1", 1, true, false, false},
      {"W\xC2\xB7m\xE2\x81\xBB\xC2\xB2\xC2\xB7sr\xE2\x81\xBB\xC2\xB9\xC2\xB7\xC2\xB5m\xE2\x81\xBB\xC2\xB9",
       1e-3, true, true, false},
      {"radiance [mW/(cm2 sr um)]", 1e-2, true, true, false},
      {"uW/cm2/nm", 1e-2, true, false, false},
      {"W/cm^2/um", 10, true, false, false},
      {"kW m**-2 um**-1", 1, true, false, false},
      {"MW/m2/nm", 1e6, true, false, false},
      {"Wm-2sr-1nm-1", 1, true, true, false},
      {"W/m2-um", 1e-3, true, false, false},
      {"W/m\xB2/nm", 1, true, false, false},
      {"radiance_W_m2_sr_nm", 1, true, true, false},
      {"irradiance_w_per_m2_per_um", 1e-3, true, false, false},
      {"W/m2/sr/cm-1", 1, true, true, true},
      {"mW m-2 sr-1 (cm-1)-1", 1e-3, true, true, true},
      {"W cm-2 sr-1 cm", 1e4, true, true, true},
      {"W/(sr m^2 m)", 1e-9, true, true, false},
      {"W/m3", 1e-9, true, false, false},
      {"erg/s/cm2/A", 1e-2, true, false, false},
      {"W/sr/nm", 1, false, true, false},
  };
  for (const Case& c : cases) {
    const auto unit = find_power_unit(c.text);
    ASSERT_TRUE(unit && unit->is_understood) << c.text;
    EXPECT_DOUBLE_EQ(unit->factor, c.factor) << c.text;
    EXPECT_EQ(unit->per_area, c.area) << c.text;
    EXPECT_EQ(unit->per_solid_angle, c.angle) << c.text;
    EXPECT_EQ(unit->per_wavenumber, c.wavenumber) << c.text;
  }
  for (const char* text : {"photons/s/cm2/nm", "W/m2", "W/m2/Hz", "J/m2/nm", "W m2"}) {
    const auto unit = find_power_unit(text);
    EXPECT_TRUE(unit && !unit->is_understood) << text;
  }
  for (const char* text : {"", "value", "a 3 W lamp", "A/W", "J. Smith, at 5 m", "Wavelength", "5 nm"})
    EXPECT_FALSE(find_power_unit(text)) << text;
}

TEST(ValueUnits, OfAbsorption) {
  const std::pair<const char*, double> cases[] = {{"1/m", 1},        {"kappa_cm-1", 100},
                                                  {"k (1/cm)", 100}, {"km^-1", 1e-3},
                                                  {"per mm", 1000},  {"m\xE2\x81\xBB\xC2\xB9", 1}};
  for (const auto& [text, factor] : cases) {
    const auto unit = find_inverse_length(text);
    ASSERT_TRUE(unit && unit->is_understood) << text;
    EXPECT_DOUBLE_EQ(unit->factor, factor) << text;
  }
  for (const char* text : {"cm2/molecule", "1/(atm cm)", "dB/km", "cross section (cm^2)"}) {
    const auto unit = find_inverse_length(text);
    EXPECT_TRUE(unit && !unit->is_understood) << text;
  }
  EXPECT_FALSE(find_inverse_length("abscoeff"));
}

// The sun in microns and per micron was read 1000 times too bright.
TEST(ValueUnits, SolarTables) {
  const auto kind = ValueKind::kIrradiance;
  const Reading quoted = read("\"Wavelength, microns\",\"E-490 W/m2/micron\"\n0.5,1930\n0.6,1750\n", kind);
  EXPECT_DOUBLE_EQ(quoted.spectrum(500), 1.93);
  EXPECT_TRUE(quoted.messages.empty());
  for (const char* header :
       {"Wavelength, microns, E-490 W/m2/micron\n", "Wavelength, microns    E-490 W/m2/micron\n",
        "Wavelength (um)\tE (W m-2 um-1)\n", "# W/m2/um\nwavelength_um,value\n", "wavelength;E\num;W/m2/um\n",
        "# wavelength in um, irradiance in W/m2/um\n", "W/m2/um against wavelength in um\n"}) {
    const Reading one = read(header + std::string("0.5 1930\n0.6 1750\n"), kind);
    EXPECT_DOUBLE_EQ(one.spectrum(500), 1.93) << header;
    EXPECT_TRUE(one.messages.empty()) << header << (one.messages.empty() ? "" : one.messages[0]);
  }
  const Reading further =
      read("Wvlgth nm,Etr W*m-2*nm-1,Global tilt  W*m-2*nm-1\n280,0.082,4.7E-23\n281,0.15,5.7E-21\n", kind);
  EXPECT_EQ(further.spectrum(280), 0.082);
  EXPECT_EQ(further.messages, std::vector<std::string>{"note: 3 columns: 'Etr W*m-2*nm-1' is read"});
}

TEST(ValueUnits, PerWavenumber) {
  const Reading s =
      read("wavenumber (cm-1),L (mW m-2 sr-1 (cm-1)-1)\n1000,100\n2000,10\n", ValueKind::kRadiance);
  // dL/d lambda = dL/d nu 1e7 / lambda^2: at 10 um 0.1 W m^-2 sr^-1 cm times 0.1 cm^-1/nm.
  EXPECT_DOUBLE_EQ(s.spectrum(10000), 0.01);
  EXPECT_DOUBLE_EQ(s.spectrum(5000), 0.004);
}

TEST(ValueUnits, ColumnsOfWavelengths) {
  const std::pair<const char*, double> cases[] = {
      {"wavelength (angstrom)", 10}, {"wavelength (\xC3\x85)", 10}, {"wavelength_m", 1e-9},
      {"lambda [mm]", 1e-6},         {"wavelength / cm", 1e-7},     {"wavelength, \xC2\xB5m", 1e-3}};
  for (const auto& [name, per_nm] : cases) {
    const std::string rows = format_number(500 * per_nm) + ";1\n" + format_number(600 * per_nm) + ";2\n";
    EXPECT_NEAR(read(name + std::string(";R\n") + rows, ValueKind::kPlain).spectrum(550), 1.5, 1e-9) << name;
  }
}

TEST(ValueUnits, AssumedUnitsAreNotedOnce) {
  const std::string data = "400 1\n500 2\n";
  using Messages = std::vector<std::string>;
  EXPECT_EQ(
      read(data, ValueKind::kRadiance).messages,
      Messages{"note: wavelengths are read as nm, values as W m^-2 sr^-1 nm^-1: the file states no units"});
  EXPECT_EQ(read("# nm\n" + data, ValueKind::kIntensity).messages,
            Messages{"note: values are read as W sr^-1 nm^-1: the file states no unit"});
  EXPECT_EQ(read("# nm\n" + data, ValueKind::kAbsorption).messages,
            Messages{"note: values are read as 1/m: the file states no unit"});
  EXPECT_EQ(read(data, ValueKind::kPlain).messages,
            Messages{"note: wavelengths are read as nm: the file states no unit"});
  EXPECT_EQ(read("# nm\n" + data, ValueKind::kPlain).messages, Messages{});
  EXPECT_EQ(read("# nm\n" + data, ValueKind::kAny).messages, Messages{});
  EXPECT_EQ(read("nm,percent\n" + data, ValueKind::kPlain).messages, Messages{});
}

TEST(ValueUnits, OtherQuantitiesAreWarnedOf) {
  const Reading sun = read("nm,W/m2/um\n400,1000\n500,2000\n", ValueKind::kRadiance);
  EXPECT_EQ(sun.messages,
            std::vector<std::string>{
                "warning: values in 'W/m2/um' are read as W m^-2 sr^-1 nm^-1: another quantity"});
  EXPECT_DOUBLE_EQ(sun.spectrum(400), 1);
}

TEST(ValueUnits, WrongOnesHaveTheirMessages) {
  const std::string power = ": must be power per interval of wavelength or wavenumber, such as W/m2/sr/nm";
  struct Case {
    const char* header;
    ValueKind kind;
    std::string message;
  };
  const Case cases[] = {
      {"nm,photons/s/cm2/nm", ValueKind::kIrradiance, "f.csv: values in 'photons/s/cm2/nm'" + power},
      {"nm,E (W/m2)", ValueKind::kIrradiance, "f.csv: values in 'W/m2'" + power},
      {"nm,W/m2/Hz", ValueKind::kIrradiance, "f.csv: values in 'W/m2/Hz'" + power},
      {"# photons/s/m2/nm", ValueKind::kRadiance, "f.csv: values in 'photons/s/m2/nm'" + power},
      {"# W/m2/nm\n# W/m2/um", ValueKind::kIrradiance,
       "f.csv: comments give values in 'W/m2/nm' and in 'W/m2/um'"},
      {"nm,W/m2/nm", ValueKind::kPlain,
       "f.csv: values in 'W/m2/nm': must be numbers without a unit, or percent"},
      {"nm,R (W/m2)", ValueKind::kPlain,
       "f.csv: values in 'W/m2': must be numbers without a unit, or percent"},
      {"nm,R uW/cm2", ValueKind::kPlain,
       "f.csv: values in 'uW/cm2': must be numbers without a unit, or percent"},
      {"nm,R (W/sr)", ValueKind::kPlain,
       "f.csv: values in 'W/sr': must be numbers without a unit, or percent"},
      {"nm,cm2/molecule", ValueKind::kAbsorption,
       "f.csv: values in 'cm2/molecule': an absorption coefficient must be in 1/m, 1/cm, 1/mm or 1/km"},
      {"frequency (THz),R", ValueKind::kPlain,
       "f.csv: a first column in 'thz': must be a wavelength in nm, um, mm, cm, m or angstrom, or a "
       "wavenumber in "
       "cm-1"},
  };
  for (const Case& c : cases) {
    const TemporaryFolder folder;
    const auto file = folder.write("f.csv", c.header + std::string("\n400,1\n500,2\n"));
    EXPECT_EQ(error_of(folder, [&] { read_spectrum_file(file, c.kind); }), c.message) << c.header;
  }
}

TEST(ValueUnits, InitialsAreNone) {
  EXPECT_EQ(read("nm,J M Smith\n400,0.5\n500,0.5\n", ValueKind::kPlain).spectrum(450), 0.5);
}

// Shares of other things in a name or a comment divided the values by 100.
TEST(ValueUnits, PercentIsAUnitOnlyWhereItIsOne) {
  const auto scale = [](const std::string& header) {
    return read(header + "\n400,40\n500,50\n", ValueKind::kAny).spectrum(400) / 40;
  };
  for (const char* header : {"nm,%",
                             "nm,percent",
                             "nm,R (%)",
                             "nm,grass [percent]",
                             "nm,leaf_percent",
                             "nm,leaf %",
                             "nm,%R",
                             "nm,Reflectance, %",
                             "nm,percent reflectance",
                             "nm,reflectance % of a white panel",
                             "nm,in percent",
                             "wavelength;R\nnm;%",
                             "Wavelength nm   Reflectance %",
                             "# reflectance in percent",
                             "# %",
                             "# units: %",
                             "# values are given in percent",
                             "# wavelength (nm), reflectance (%)",
                             "# column 2: % reflectance",
                             "# Y Units: Reflectance (percentage)"})
    EXPECT_DOUBLE_EQ(scale(header), 0.01) << header;
  for (const char* header :
       {"# Reflectance of loam, 15 % moisture", "# reflectance, 95 % confidence", "nm,soil 10% moisture",
        "# values: reflectance factor, 99 % Spectralon panel", "nm,R at 50% RH",
        "nm,reflectance (0-1, not %)", "nm,reflectance not in %", "# reflectance of a 50% reflectance panel",
        "# humidity (%): 40", "# moisture in percent: 12.5", "# reflectance of a ten percent grey",
        "nm,soil_10_percent"})
    EXPECT_EQ(scale(header), 1) << header;
}

TEST(ValueUnits, FractionsThatAreStatedAsPercentAreWarnedOf) {
  using Texts = std::vector<std::string>;
  const Reading fractions = read("nm,reflectance [%]\n400,0.25\n500,0.5\n", ValueKind::kPlain);
  EXPECT_DOUBLE_EQ(fractions.spectrum(500), 0.005);
  EXPECT_EQ(fractions.messages,
            Texts{"warning: values up to 0.5 are read as percent, as the file states: up to 0.005"});
  EXPECT_EQ(read("nm,reflectance [%]\n400,0.25\n500,1.5\n", ValueKind::kPlain).messages, Texts{});
  EXPECT_EQ(read("nm,reflectance [%]\n400,0\n500,0\n", ValueKind::kPlain).messages, Texts{});
}

// Prose in comments is no unit of the values.
TEST(ValueUnits, OtherComments) {
  const auto read_radiance = [](const std::string& comment) {
    return read("# " + comment + "\n# nm\n400 1\n500 2\n", ValueKind::kRadiance).spectrum(400);
  };
  EXPECT_EQ(read_radiance("lamp of 50 W at 1000 W/m2, slit 5 um"), 1);
  EXPECT_EQ(read_radiance("radiance in mW/cm2/sr/nm"), 10);
  EXPECT_EQ(
      read(
          "# {\"radiance\": \"mW/cm2/sr/nm\", \"emisscoeff\": \"mW/cm3/sr/nm\"}\nnm,radiance\n400,1\n500,2\n",
          ValueKind::kRadiance)
          .spectrum(400),
      10);
}

TEST(ValueUnits, OfResponses) {
  const TemporaryFolder folder;
  Messages messages;
  const auto responses = read_response_file(
      folder.write("qe.csv", "wavelength_nm,red (%),gain (A/W)\n400,50,3\n500,60,4\n"), messages.sink());
  EXPECT_DOUBLE_EQ(responses[0].second(400), 0.5);
  EXPECT_EQ(responses[1].second(400), 3);
  EXPECT_TRUE(messages.texts.empty());
  read_response_file(folder.write("raw.csv", "0.4,50\n0.5,60\n"), messages.sink());
  EXPECT_EQ(messages.texts,
            std::vector<std::string>{"wavelengths up to 0.5 are read as nm: the file states no unit"});
}

}  // namespace
}  // namespace kiloband::test
