// Names of bands and channels, and the little texts of headers.
#include <gtest/gtest.h>

#include <set>

#include "cube/cube_text.hpp"
#include "cube/exr/exr_names.hpp"
#include "cube_support.hpp"

namespace kiloband {
namespace {

TEST(BandNames, EqualCentresGetSuffixesInOrder) {
  const std::vector<Band> bands = {{{400, 410, ""}, false}, {{402, 408, ""}, false},  {{390, 400, ""}, false},
                                   {{404, 406, ""}, false}, {{400, 410, "a"}, false}, {{1, 2, "a"}, true}};
  EXPECT_EQ(unique_band_names(bands),
            (std::vector<std::string>{"405nm", "405nm_2", "395nm", "405nm_3", "a", "a_2"}));
}

TEST(BandNames, ASuffixedNamePassesOverNamesThatAreTaken) {
  EXPECT_EQ(make_unique_names({"a", "a", "a_2", "a", "a_2"}),
            (std::vector<std::string>{"a", "a_3", "a_2", "a_4", "a_2_2"}));
}

TEST(ExrNames, FollowTheLayout) {
  EXPECT_EQ(spectral_name(550), "S0.550,000000nm");
  EXPECT_EQ(spectral_name(374.6884), "S0.374,688400nm");
  const std::vector<Band> bands = {{{400, 410, "x"}, false}, {{402, 408, ""}, false}, {{0, 0, "Y"}, true}};
  const auto names = exr_band_names(bands);
  EXPECT_EQ(names, (std::vector<std::string>{"S0.405,000000nm", "S0.405,000000nm_2", "response.Y"}));
  EXPECT_TRUE(parse_spectral_name(names[0]));
  EXPECT_FALSE(
      parse_spectral_name(names[1]));  // other readers ignore it instead of taking another wavelength
  EXPECT_FALSE(parse_spectral_name(names[2]));
}

TEST(ExrNames, AreParsedByTheGrammarOfTheLayout) {
  const struct {
    const char* name;
    double nm;
  } good[] = {
      {"S0.550nm", 550},    {"S0.550,5nm", 550.5},   {"S0.,5um", 500},   {"S3.1,5E3nm", 1500},
      {"T.5e-7m", 500},     {"S0.0,55um", 550},      {"S0.10um", 10000}, {"S0.600THz", 499.65409666666667},
      {"S0.5,5E+2nm", 550}, {"S0.550000pm", 0.55e3}, {"S0.1,mm", 1e6}};
  for (const auto& test : good) {
    const auto name = parse_spectral_name(test.name);
    ASSERT_TRUE(name) << test.name;
    EXPECT_NEAR(name->centre_nm, test.nm, 1e-12 * test.nm) << test.name;
  }
  for (const char* bad : {"S4.550nm", "S0.550", "S0.nm", "S0.,nm", "S0.550.5nm", "S0.550nm_2", "xS0.550nm",
                          "S0.-5nm", "S0.5,5,5nm", "T.500nm.600nm", "var.S0.550,0nm", "S0.0nm", "S0.1e999nm",
                          "S0.550 nm", "", "S0.550qm", "R"})
    EXPECT_FALSE(parse_spectral_name(bad)) << bad;
}

TEST(ExrNames, OtherUnitsBecomeTheNanometresThatAreMeant) {
  EXPECT_EQ(parse_spectral_name("S0.1,005um")->centre_nm, 1005);
  EXPECT_EQ(parse_spectral_name("S0.0,0000003001m")->centre_nm, 300.1);
  EXPECT_EQ(parse_spectral_name("S0.550100pm")->centre_nm, 550.1);
  EXPECT_EQ(parse_sensitivity("0.3001um:1;1.005um:1;")->min_nm, 300.1);
}

TEST(ExrNames, SensitivitiesCarryExactBounds) {
  const Channel channel{380 + 1 / 3.0, 390.1, ""};
  EXPECT_EQ(sensitivity_text({545, 555, ""}), "545nm:1;555nm:1;");
  const auto read = parse_sensitivity(sensitivity_text(channel));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->min_nm, channel.min_nm);
  EXPECT_EQ(read->max_nm, channel.max_nm);
  EXPECT_TRUE(read->box);
  const auto triangle = parse_sensitivity("545nm:0;0.55um:1;555nm:0");
  ASSERT_TRUE(triangle);
  EXPECT_EQ(triangle->max_nm, 555);
  EXPECT_FALSE(triangle->box);
  for (const char* bad :
       {"", "545nm:1;", "545:1;555:1", "545nm=1;555nm=1", "550nm:1;550nm:1", "545nm:a;555nm:1"})
    EXPECT_FALSE(parse_sensitivity(bad)) << bad;
}

TEST(CubeText, EncodedTextComesBack) {
  for (const char* text : {"", " ", "a,b", "100%", "%41", "a\nb\tc", "{x}", "\x7f", " a "}) {
    const std::string encoded = encode_text(text, ",{}");
    EXPECT_EQ(decode_text(encoded), text);
    EXPECT_EQ(encoded.find_first_of(",{}\n\t"), std::string::npos);
    EXPECT_EQ(trimmed(encoded), encoded);
  }
  EXPECT_EQ(decode_text("%zz%-5%+5%4"), "%zz%-5%+5%4");
}

TEST(CubeText, NumbersAreWhole) {
  EXPECT_EQ(parse_number(" +1.5 "), 1.5);
  EXPECT_FALSE(parse_number("1.5x"));
  EXPECT_FALSE(parse_unsigned("-1"));
  EXPECT_FALSE(parse_unsigned("99999999999999999999"));
  EXPECT_EQ(format_short(384.8780487804878), "384.878049");
  EXPECT_EQ(format_short(1000), "1000");
}

}  // namespace
}  // namespace kiloband
