#include <gtest/gtest.h>

#include "spectral/files/spectrum_files.hpp"
#include "spectral/files/spectrum_units.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

Spectrum read_text(const std::string& content, std::vector<Diagnostic>* diagnostics = nullptr) {
  const TemporaryFolder folder;
  return read_spectrum_file(folder.write("a.spd", content), ValueKind::kPlain, [&](const Diagnostic& d) {
    if (diagnostics) diagnostics->push_back(d);
  });
}

TEST(SpectrumFile, TwoColumnsWithCommentsAndFurtherColumns) {
  const Spectrum s = read_text("# a comment\n400 0.1 ignored 7\n\n500\t0.3\r\n 600, 0.2, x # more\n");
  EXPECT_EQ(s.knots_nm().size(), 3u);
  EXPECT_DOUBLE_EQ(s(450), 0.2);
  EXPECT_EQ(s(399), 0);
  EXPECT_EQ(s(601), 0);
  EXPECT_FALSE(s.extrapolates());
}

TEST(SpectrumFile, DescendingIsTurnedRound) {
  const Spectrum s = read_text("600 3\n500 2\n400 1\n");
  EXPECT_EQ(s(400), 1);
  EXPECT_EQ(s(550), 2.5);
}

TEST(SpectrumFile, EndsOfLinesOfOldMacs) {
  const Spectrum s = read_text("# a comment\r400 1\r500 2\r600 3\r");
  EXPECT_EQ(s.knots_nm().size(), 3u);
  EXPECT_EQ(s(550), 2.5);
}

TEST(SpectrumFile, CsvHeaderAndItsUnits) {
  EXPECT_EQ(read_text("wavelength_nm,value\n400,1\n500,2\n")(500), 2);
  EXPECT_EQ(read_text("Wavelength (micrometers),Reflectance\n0.4,1\n0.5,2\n")(500), 2);
  EXPECT_EQ(read_text("wavelength_um;value\n0.4;1\n0.5;2\n")(500), 2);
  EXPECT_EQ(read_text("\xC2\xB5m,value\n0.4,1\n0.5,2\n")(500), 2);
  EXPECT_EQ(read_text("wavenumber,value\n10000,1\n20000,2\n")(500), 2);
  EXPECT_DOUBLE_EQ(
      read_text("Title of the table,,\nwavelength_um,reflectance (%),error\n0.4,10,1\n0.5,20,1\n")(500), 0.2);
}

TEST(SpectrumFile, UnitsInComments) {
  EXPECT_EQ(read_text("# wavelength in microns, reflectance\n0.4 1\n0.5 2\n")(500), 2);
  EXPECT_EQ(read_text("# grain size 5 um\n400 1\n500 2\n")(500), 2);
  EXPECT_EQ(read_text("# grain size 5 um, wavelength [nm]\n400 1\n500 2\n")(500), 2);
  EXPECT_EQ(read_text("# Wavenumber (cm^-1)\n20000 2\n25000 1\n")(500), 2);
  EXPECT_EQ(read_text("# unit: um\n0.4 1\n0.5 2\n")(500), 2);
  EXPECT_DOUBLE_EQ(read_text("# reflectance in percent\n400 10\n500 20\n")(500), 0.2);
  EXPECT_EQ(read_text("# measured at 50 percent humidity, 20 C\n400 10\n500 20\n")(500), 20);
}

// RADIS states wavenumbers even where its first column is in nm.
TEST(SpectrumFile, RadisHeader) {
  const std::string header =
      "# waveunit cm-1\n#    wavenum_max          2410 cm-1\n#    wavenum_min          2270 cm-1\n";
  EXPECT_EQ(read_text(header + "4405 1\n4150 2\n")(4150), 2);
  EXPECT_EQ(read_text(header + "2270.5 1\n2400 2\n")(1e7 / 2400), 2);
  EXPECT_EQ(
      read_text(
          "# {\"waveunit\": \"cm-1\", \"wavenum_min\": 2082.7, \"wavenum_max\": 2272.1}\nwavespace,abscoeff\n"
          "2082.7,1\n2200,2\n")(1e7 / 2200),
      2);
}

TEST(SpectrumFile, UnstatedMicrometresAreReadAsNanometresWithAWarning) {
  std::vector<Diagnostic> diagnostics;
  read_text("0.4 1\n14 2\n", &diagnostics);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].message, "wavelengths up to 14 are read as nm: the file states no unit");
  EXPECT_EQ(diagnostics[0].severity, Severity::kWarning);
  read_text("# nm\n400 1\n800 2\n", &diagnostics);
  EXPECT_EQ(diagnostics.size(), 1u);
}

std::string ecostress(const std::string& x_units, const std::string& y_units, const std::string& count,
                      const std::string& data) {
  return "Name: Paint \xB5\r\nDescription: 12 samples, 5 um grains: dull\r\nFirst Column: X\r\nX Units: " +
         x_units + "\r\nY Units:" + y_units + "\r\nFirst X Value:  0.3\r\nNumber of X Values: " + count +
         "\r\nAdditional Information: none\r\n\r\n" + data;
}

TEST(SpectrumFile, EcostressUnitsAndOrder) {
  const Spectrum s = read_text(ecostress("Wavelength (micrometers)", "Reflectance (percent)", "3",
                                         " 14.0\t 4.0\r\n 10.0\t 50\r\n 0.5 8\r\n"));
  EXPECT_DOUBLE_EQ(s(10000), 0.5);
  EXPECT_DOUBLE_EQ(s(500), 0.08);
  EXPECT_EQ(s(14001), 0);
  EXPECT_EQ(read_text(ecostress("Wavenumber (cm-1)", "Emissivity", "2", "1000 0.9\n2000 0.8\n"))(5000), 0.8);
}

TEST(SpectrumFile, WrongFilesHaveTheirMessages) {
  const TemporaryFolder folder;
  const std::string kHeaderRule =
      " (before the first row at most 3 lines without numbers are skipped; others must begin with '#')";
  const std::string kDecimalCommas =
      "f.txt:1: numbers with decimal commas between commas: write points, or ';' between columns";
  const std::pair<std::string, std::string> cases[] = {
      {"", "f.txt: no data"},
      {"# only\n", "f.txt: no data"},
      {"wavelength,value\n", "f.txt: no data"},
      {"a,b\nc,d\ne,f\ng,h\n1,2\n", "f.txt:4: 'g' is not a number" + kHeaderRule},
      {"400\n", "f.txt:1: 1 columns: must be at least 2"},
      {"400 0.1\n500\n", "f.txt:2: 1 columns: must be at least 2"},
      {"400 0.1\nx500 0.2\n", "f.txt:2: 'x500' is not a number"},
      {"x400 0.1\n", "f.txt:1: 'x400' is not a number" + kHeaderRule},
      {"Sample 12 grass\n400 0.1\n500 0.2\n", "f.txt:1: 'Sample' is not a number" + kHeaderRule},
      {"400 0.1\n", "f.txt:1: one row: a spectrum needs at least 2"},
      {"400,0,2\n500,0,35\n600,1,0\n", kDecimalCommas},
      {"# nm\nwavelength,value\n400,12,5\n500,10,2\n", "f.txt:3" + kDecimalCommas.substr(7)},
      {"400 0.1\n500 0,2\n", "f.txt:2: '500 0' is not a number"},
      {"400,0.1\n500,\n", "f.txt:2: '' is not a number"},
      {"400 nan\n", "f.txt:1: value nan: must be finite"},
      {"400 1\n500 -inf\n", "f.txt:2: value -inf: must be finite"},
      {"400 1e999\n", "f.txt:1: value inf: must be finite"},
      {"nan 1\n", "f.txt:1: wavelength nan nm: must be finite and positive"},
      {"-400 1\n", "f.txt:1: wavelength -400 nm: must be finite and positive"},
      {"0 1\n", "f.txt:1: wavelength 0 nm: must be finite and positive"},
      {"400 1\n400 2\n", "f.txt:2: wavelength 400 nm is repeated"},
      {"# wavelength um\n.4 1\n.5 2\n.5 2\n", "f.txt:4: wavelength 0.5 um is repeated"},
      {"400 1\n500 2\n450 3\n", "f.txt:3: wavelength 450 nm after 500 nm: the order changes"},
      {"600 1\n500 2\n550 3\n", "f.txt:3: wavelength 550 nm after 500 nm: the order changes"},
      {"wavenumber,value\n2000,1\n1000,2\n1500,1\n",
       "f.txt:4: wavenumber 1500 cm-1 after 1000 cm-1: the order changes"},
      {"# wavelength nm\n# wavelength um\n400 1\n", "f.txt: comments give wavelengths in nm and in um"},
      {std::string("\x7F"
                   "ELF\0\1\2\n\xFF\xFE",
                   10),
       "f.txt: no data"},
      {"400 1\n\x01\x02\x03 \xFF\n", "f.txt:2: '\?\?\?' is not a number"},
      {"wavenumber,value\n1e-320,1\n", "f.txt: wavelength inf nm: not finite or not distinct"},
      {ecostress("Parsecs", "Reflectance (percent)", "2", "1 2\n2 3\n"),
       "f.txt: X Units 'Parsecs': must name nm, micrometers or cm-1"},
      {ecostress("Wavelength (micrometers)", "Reflectance", "3", "1 2\n2 3\n"),
       "f.txt: the header states 3 values, the file has 2"},
      {ecostress("Wavelength (micrometers)", "Reflectance", "2", "1 2\n2 x\n"),
       "f.txt:11: 'x' is not a number"},
      {ecostress("Wavelength (micrometers)", "Reflectance", "2", "1 2\n1 3\n"),
       "f.txt:11: wavelength 1 um is repeated"},
      {ecostress("Wavelength (micrometers)", "Reflectance", "0", ""), "f.txt: no data"},
  };
  for (const auto& [content, message] : cases) {
    const auto file = folder.write("f.txt", content);
    EXPECT_EQ(error_of(folder, [&] { read_spectrum_file(file); }), message) << content;
  }
  EXPECT_EQ(error_of(folder, [&] { read_spectrum_file(folder.path() / "none"); }),
            "none: cannot be opened: no such file");
  EXPECT_EQ(error_of([&] { read_spectrum_file("/dev/zero"); }), "/dev/zero: is not a regular file");
}

TEST(SpectrumFile, LongLinesAreNoTrouble) {
  std::string wide = "400";
  for (int i = 0; i < 200000; ++i) wide += " 1";
  EXPECT_EQ(read_text(wide + "\n500 2\n")(400), 1);
  EXPECT_EQ(read_text(std::string(1000000, '#') + "\n400 1\n500 2\n")(500), 2);
}

TEST(SpectrumFile, WhichOfSeveralColumnsIsReadIsTold) {
  const auto told = [](const std::string& text) {
    std::vector<Diagnostic> diagnostics;
    read_text(text, &diagnostics);
    return diagnostics.empty()                          ? std::string()
           : diagnostics[0].severity == Severity::kNote ? "note: " + diagnostics[0].message
                                                        : "warning: " + diagnostics[0].message;
  };
  EXPECT_EQ(told("nm,extraterrestrial,global,direct\n400,1,2,3\n500,1.5,2,3\n"),
            "note: 4 columns: 'extraterrestrial' is read");
  EXPECT_EQ(told("row nm,wavelength,value\n1,400,2\n2,500,2\n"),
            "warning: 3 columns: 'wavelength' is read, and the first as wavelengths");
  EXPECT_EQ(told("# nm\n400 1 0.1\n500 2 0.1\n"),
            "warning: 3 columns without names of their own: the second is read");
  EXPECT_EQ(told("nm,value,\n400,1.5,\n500,2,\n"), "");
}

TEST(SpectrumFile, EmissivitiesAreNoReflectances) {
  std::vector<Diagnostic> diagnostics;
  read_text("nm,Emissivity\n400,0.9\n500,0.8\n", &diagnostics);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].message, "values are read as a reflectance, the file states emissivity");
  read_text(ecostress("Wavelength (micrometers)", "Emissivity", "2", "1 0.9\n2 0.8\n"), &diagnostics);
  EXPECT_EQ(diagnostics.size(), 2u);
}

TEST(SpectrumFile, FilesOfIndicesAreRefused) {
  const TemporaryFolder folder;
  const auto file = folder.write("n.yml", "DATA:\n  - type: formula 1\n");
  EXPECT_EQ(
      error_of(folder, [&] { read_spectrum_file(file); }),
      "n.yml: a file of n and k, which a material reads ('metal', 'int_material'): a spectrum is a table of "
      "two columns");
}

TEST(ResponseFile, HeaderNamesTheColumns) {
  const TemporaryFolder folder;
  const auto responses =
      read_response_file(folder.write("eye.csv", "wavelength_um,x,y bar,z\n0.4,1,2,3\n0.5,4,5,6\n"));
  ASSERT_EQ(responses.size(), 3u);
  EXPECT_EQ(responses[1].first, "y bar");
  EXPECT_EQ(responses[1].second(500), 5);
  EXPECT_EQ(responses[2].second(450), 4.5);
}

TEST(ResponseFile, WithoutHeaderTheStemIsTheName) {
  const TemporaryFolder folder;
  const auto one = read_response_file(folder.write("green.txt", "# nm\n500 0.1\n400 0.2\n"));
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].first, "green");
  EXPECT_EQ(one[0].second(400), 0.2);
  const auto three = read_response_file(folder.write("rgb.csv", "400,1,2,3\n500,1,2,3\n"));
  ASSERT_EQ(three.size(), 3u);
  EXPECT_EQ(three[2].first, "rgb_3");
}

TEST(ResponseFile, ModisTable) {
  const TemporaryFolder folder;
  const auto responses =
      read_response_file(folder.write("rsr.31",
                                      "#| Band Channel Wavelength RSR\n#|----\n31 1 10.5 0.01\n31 1 11 1\n31 "
                                      "2 10.6 0.5\n31 2 10.7 -99\n31 2 10.8 0.4\n"));
  ASSERT_EQ(responses.size(), 2u);
  EXPECT_EQ(responses[0].first, "band31_detector1");
  EXPECT_EQ(responses[0].second(11000), 1);
  EXPECT_DOUBLE_EQ(responses[1].second(10700), 0.45);
}

TEST(ResponseFile, WrongFilesHaveTheirMessages) {
  const TemporaryFolder folder;
  std::string wide = "400";
  for (int i = 0; i < 5000; ++i) wide += ",1";
  const std::pair<std::string, const char*> cases[] = {
      {"", "f.csv: no data"},
      {"wavelength_nm,a,a\n400,1,2\n", "f.csv: column name 'a' is repeated"},
      {"wavelength_nm,a,\n400,1,2\n", "f.csv: column 3 has no name"},
      {"wavelength_nm,a,b,c\n400,1,2\n", "f.csv: the header names 4 columns, the rows have 3"},
      {"wavelength_nm,a,b\n400,1,2\n500,1\n", "f.csv:3: 2 columns: must be 3"},
      {"wavelength_nm,a,b\n400,1,2\n500,1,2,3\n", "f.csv:3: 4 columns: must be 3"},
      {"wavelength_nm,a,b\n400,1,nan\n", "f.csv:2: value nan: must be finite"},
      {"wavelength_nm,a,b\n400,1,-3e38\n",
       "f.csv: response 'b' -3e+38 at 400 nm: must be from -1e+15 to 1e+15"},
      {"wavelength_nm,a,b\n400,1,2\n", "f.csv:2: one row: a spectrum needs at least 2"},
      {wide + "\n", "f.csv:1: more than 4097 columns"},
      {"# Band Channel Wavelength RSR\n1 1 500 -99\n", "f.csv: no data"},
      {"# Band Channel Wavelength RSR\n1 1 500 1\n1 1 500 1\n", "f.csv:3: wavelength 500 nm is repeated"},
      {"# Band Channel Wavelength RSR\n1 1 500 inf\n", "f.csv:2: value inf: must be finite"},
  };
  for (const auto& [content, message] : cases) {
    const auto file = folder.write("f.csv", content);
    EXPECT_EQ(error_of(folder, [&] { read_response_file(file); }), message) << content.substr(0, 80);
  }
}

TEST(Units, NamesInText) {
  EXPECT_EQ(find_unit("Wavelength (\xB5m)"), WavelengthUnit::kMicrometre);
  EXPECT_EQ(find_unit("number of columns"), std::nullopt);
  EXPECT_EQ(find_unit("lambda [cm\xE2\x81\xBB\xC2\xB9]"), WavelengthUnit::kWavenumber);
  EXPECT_DOUBLE_EQ(to_nanometres(2000, WavelengthUnit::kWavenumber), 5000);
}

}  // namespace
}  // namespace kiloband::test
