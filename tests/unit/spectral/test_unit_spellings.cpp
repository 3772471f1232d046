// The many ways in which files spell units of wavelength and powers of ten: read as meant, or refused.
#include <gtest/gtest.h>

#include "spectral/channels.hpp"
#include "spectral/files/spectrum_files.hpp"
#include "spectral/files/spectrum_units.hpp"
#include "spectral/files/text_table.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

Spectrum plain(const TemporaryFolder& folder, const std::string& content,
               ValueKind kind = ValueKind::kPlain) {
  return read_spectrum_file(folder.write("f.csv", content), kind, [](const Diagnostic&) {});
}

std::string refusal(const std::string& content, ValueKind kind = ValueKind::kPlain) {
  const TemporaryFolder folder;
  return error_of(folder, [&] { plain(folder, content, kind); });
}

TEST(UnitSpellings, InverseCentimetres) {
  for (const char* name : {"cm-1", "nu (cm^{-1})", "nu (cm^(-1))", "nu (cm$^{-1}$)", "nu [cm -1]",
                           "nu (1 / cm)", "nu per cm", "nu_per_cm", "sigma_cm-1", "nu (cm\u20131)",
                           "nu (cm\u22121)", "nu (cm\u20111)", "nu (cm\xE2\x81\xBB\xC2\xB9)", "nu (cm**-1)",
                           "wavenumber", "Wavenumber (cm-1)", "wavenumbers in 1/cm"}) {
    EXPECT_EQ(find_unit(name), WavelengthUnit::kWavenumber) << name;
    const TemporaryFolder folder;
    EXPECT_NEAR(plain(folder, name + std::string(",r\n12500,1\n25000,3\n"))(600), 2, 1e-9) << name;
  }
}

// Read as the length itself, or as cm-1, they gave images of other wavelengths without a word.
TEST(UnitSpellings, OtherInverseLengthsAreRefused) {
  const std::pair<const char*, const char*> cases[] = {{"sigma (1/um)", "1/um"},
                                                       {"wavenumber (1/um)", "1/um"},
                                                       {"wavenumber (m-1)", "m-1"},
                                                       {"wavenumber in m^-1", "m^-1"},
                                                       {"1/nm", "1/nm"},
                                                       {"inverse wavelength (nm^{-1})", "nm^{-1}"},
                                                       {"k (rad/um)", "rad/um"},
                                                       {"k (rad/cm)", "rad/cm"},
                                                       {"k (rad cm-1)", "rad cm-1"},
                                                       {"k (rad per m)", "rad per m"},
                                                       {"sigma per micron", "per micron"},
                                                       {"frequency_THz", "thz"}};
  for (const auto& [name, unit] : cases)
    EXPECT_EQ(refusal(name + std::string(";r\n1;0.1\n3;0.9\n")),
              "f.csv: a first column in '" + std::string(unit) +
                  "': must be a wavelength in nm, um, mm, cm, m or angstrom, or a wavenumber in cm-1")
        << name;
  EXPECT_NE(refusal("# wavenumber in 1/m\n1 0.1\n3 0.9\n"), "accepted");
  EXPECT_EQ(refusal("# wavelength in um, absorption in 1/m\n1 0.1\n3 0.9\n", ValueKind::kAbsorption),
            "accepted");
  EXPECT_EQ(refusal("wavelength (um)  absorption  (1/m)\n1 0.1\n3 0.9\n", ValueKind::kAbsorption),
            "accepted");
}

TEST(UnitSpellings, QuantitiesOverTheirUnit) {
  EXPECT_EQ(find_unit("lambda / nm"), WavelengthUnit::kNanometre);
  EXPECT_EQ(find_unit("wavelength / cm"), WavelengthUnit::kCentimetre);
  EXPECT_EQ(find_unit("lambda/um"), WavelengthUnit::kMicrometre);
}

// 10^-3 before the unit made values a thousand times too large.
TEST(UnitSpellings, PowersOfTenAreRefused) {
  for (const char* unit :
       {"10^-3 W/m2/sr/nm", "1e-3 W/m2/sr/nm", "x1000 W/m2/sr/nm", "10\xE2\x81\xBB\xC2\xB3 W/m2/sr/nm",
        "10-3 W/m2/sr/nm", "W/m2/sr/nm x 10^3", "W/m2/sr/nm * 1000", "10^{-3} W/m2/sr/nm",
        "\u00d71000 W/m2/sr/nm", "1000 W/m2/sr/nm"}) {
    const std::string message =
        refusal("nm,radiance (" + std::string(unit) + ")\n400,5\n500,5\n", ValueKind::kRadiance);
    EXPECT_NE(message.find("write the values without the factor"), std::string::npos)
        << unit << ": " << message;
  }
  // A header that parts at its blank as the rows do.
  EXPECT_NE(refusal("10^-3 W/m2/sr/nm\n400,5\n500,5\n", ValueKind::kRadiance).find("without the factor"),
            std::string::npos);
  EXPECT_EQ(refusal("W/m2/sr/nm radiance\n400,5\n500,5\n", ValueKind::kRadiance), "accepted");
  EXPECT_NE(refusal("# Radiance in 10^-3 W/m2/sr/nm\n400 5\n500 5\n", ValueKind::kRadiance), "accepted");
  EXPECT_NE(refusal("nm;absorption (10^-3 cm-1)\n400;5\n500;5\n", ValueKind::kAbsorption), "accepted");
  for (const char* name :
       {"wavelength (10^-7 m)", "wavenumber (10^3 cm-1)", "wavelength (1e-6 m)", "wavelength (nm x 10)"})
    EXPECT_NE(refusal(name + std::string(";r\n4;1\n8;1\n")), "accepted") << name;
  for (const char* unit :
       {"W/m2/sr/nm", "1 W/m2/sr/nm", "band 10, W/m2/sr/nm", "E-490 W/m2/sr/nm", "at 1000 h, W/m2/sr/nm"})
    EXPECT_EQ(refusal("nm;radiance " + std::string(unit) + "\n400;5\n500;5\n", ValueKind::kRadiance),
              "accepted")
        << unit;
  EXPECT_EQ(refusal("# a step of 10 nm\nwavelength (nm), 10 nm apart;r\n400;5\n500;5\n"), "accepted");
}

// What begins with 10 and goes on to more is a range: data of the infrared begin there.
TEST(UnitSpellings, RangesAreNoPowersOfTen) {
  const TemporaryFolder folder;
  for (const char* comment :
       {"# Wavelength 10-12 um", "# wavelengths from 10-14 um", "# Wavelength (um) 10-12",
        "# Wavelength 10\u201312 \u00b5m", "# wavelengths in um, 10-12"})
    EXPECT_NEAR(plain(folder, comment + std::string("\n10,1\n12,3\n"))(11000), 2, 1e-9) << comment;
  EXPECT_NEAR(plain(folder, "radiance W/m2/sr/um 10-12 um\n10,1000\n12,3000\n", ValueKind::kRadiance)(11000),
              2, 1e-9);
  EXPECT_EQ(refusal("wavelengths (10 nm);r\n400;5\n500;5\n"), "accepted");
}

TEST(UnitSpellings, PowerWithTypographicSigns) {
  for (const char* unit :
       {"W m\u20132 sr\u20131 nm\u20131", "W m\u20112 sr\u20111 nm\u20111", "W m$^{-2}$ sr$^{-1}$ nm$^{-1}$",
        "W m -2 sr -1 nm -1", "W per square meter per steradian per nanometer"}) {
    const TemporaryFolder folder;
    const Spectrum s =
        plain(folder, "nm;radiance (" + std::string(unit) + ")\n400;5\n500;5\n", ValueKind::kRadiance);
    EXPECT_DOUBLE_EQ(s(450), 5) << unit;
  }
  EXPECT_NE(refusal("nm;L (W m\u20142 sr nm)\n400;5\n500;5\n", ValueKind::kRadiance),
            "accepted");  // an em dash
  EXPECT_NE(refusal("nm;L (W m2 sr nm)\n400;5\n500;5\n", ValueKind::kRadiance), "accepted");
}

// A letter of UTF-8 whose first byte is Latin-1's sign of the angstrom made wavelengths ten times too short.
TEST(UnitSpellings, LettersOfOtherLanguages) {
  EXPECT_EQ(find_unit("\xC5\x9Brodek (nm)"), WavelengthUnit::kNanometre);               // Polish
  EXPECT_EQ(find_unit("\xC5\xA1\xC3\xAD\xC5\x99ka (nm)"), WavelengthUnit::kNanometre);  // Czech
  EXPECT_EQ(find_unit("\xC5\x91 (um)"), WavelengthUnit::kMicrometre);                   // Hungarian
  EXPECT_EQ(find_unit("\xC5 "), WavelengthUnit::kAngstrom);                             // Latin-1
  EXPECT_EQ(find_unit("Wellenl\xC3\xA4nge (\xC3\x85)"), WavelengthUnit::kAngstrom);
  EXPECT_EQ(find_unit("wavelength (\xC3\x85ngstr\xC3\xB6m)"), WavelengthUnit::kAngstrom);
  EXPECT_EQ(find_unit("v\xE5gl\xE4ngd (\xC5ngstr\xF6m)"), WavelengthUnit::kAngstrom);
}

TEST(UnitSpellings, NamesOfPeopleAreNoUnits) {
  const TemporaryFolder folder;
  EXPECT_NEAR(plain(folder, "Measured by M Rossi\n400 0.5\n800 0.7\n")(600), 0.6, 1e-12);
  EXPECT_NEAR(plain(folder, "Spectrum of Ang and others\n400 0.5\n800 0.7\n")(600), 0.6, 1e-12);
  EXPECT_EQ(find_unit("wavelength (Ang)"), WavelengthUnit::kAngstrom);
  EXPECT_EQ(find_unit("centre wavelength of the band (m)"), WavelengthUnit::kMetre);
}

TEST(UnitSpellings, BandsFiles) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& content) {
    const auto file = folder.write("b.csv", content);
    return error_of(folder, [&] { read_channels_file(file); });
  };
  for (const char* header : {"min (1/um),max", "min_THz,max_THz", "min (10^3 cm-1),max"})
    EXPECT_NE(error(header + std::string("\n1.5,2\n")), "accepted") << header;
  const auto file = folder.write("b.csv", "\xC5\x9Brodek min (nm),max\n5000,6000\n");
  EXPECT_EQ(read_channels_file(file).front().min_nm, 5000);
}

}  // namespace
}  // namespace kiloband::test
