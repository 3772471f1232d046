#include <gtest/gtest.h>

#include "spectral/channels.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

TEST(Channels, RangeGivesEqualChannelsThatShareEdges) {
  const ChannelList channels = parse_channels("380:780:40");
  ASSERT_EQ(channels.size(), 40u);
  EXPECT_EQ(channels.front().min_nm, 380);
  EXPECT_EQ(channels.back().max_nm, 780);
  for (std::size_t i = 0; i + 1 < channels.size(); ++i) EXPECT_EQ(channels[i].max_nm, channels[i + 1].min_nm);
  EXPECT_DOUBLE_EQ(channels[7].width_nm(), 10);
  EXPECT_DOUBLE_EQ(channels[7].centre_nm(), 455);
}

TEST(Channels, RangeTakesFractionsAndBlanks) {
  const ChannelList channels = parse_channels(" 400 : 400.3 :3 ");
  ASSERT_EQ(channels.size(), 3u);
  EXPECT_NEAR(channels[1].min_nm, 400.1, 1e-9);
  EXPECT_EQ(channels[2].max_nm, 400.3);
}

TEST(Channels, ListKeepsOrderOverlapsAndGaps) {
  const ChannelList channels = parse_channels("8000-1.2e4, 400-410.5,405 - 500");
  ASSERT_EQ(channels.size(), 3u);
  EXPECT_EQ(channels[0].max_nm, 12000);
  EXPECT_EQ(channels[1].max_nm, 410.5);
  EXPECT_EQ(channels[2].min_nm, 405);
  EXPECT_EQ(hull(channels).min_nm, 400);
  EXPECT_EQ(hull(channels).max_nm, 12000);
  EXPECT_EQ(parse_channels("1e-1-2e-1")[0].max_nm, 0.2);
}

TEST(Channels, EveryBrokenRuleHasItsMessage) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "bands '': no channels"},
      {"  ", "bands '  ': no channels"},
      {"380", "bands '380': '380': must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ..."},
      {"380:780", "bands '380:780': must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ..."},
      {"380:780:4:1", "bands '380:780:4:1': must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ..."},
      {"780:380:40", "bands '780:380:40': the interval is reversed: 780 nm is above 380 nm"},
      {"380:380:1", "bands '380:380:1': the interval is empty"},
      {"380:780:0", "bands '380:780:0': count '0': must be a whole number from 1"},
      {"380:780:-4", "bands '380:780:-4': count '-4': must be a whole number from 1"},
      {"380:780:4.5", "bands '380:780:4.5': count '4.5': must be a whole number from 1"},
      {"380:780:", "bands '380:780:': count '': must be a whole number from 1"},
      {"380:780:1048577", "bands '380:780:1048577': 1048577 channels: at most 1048576"},
      {"380:780:99999999999999999999",
       "bands '380:780:99999999999999999999': '99999999999999999999' channels: at most 1048576"},
      {"a:780:4", "bands 'a:780:4': 'a' is not a number"},
      {"0:780:4", "bands '0:780:4': wavelength 0 nm: must be finite and positive"},
      {"-5:780:4", "bands '-5:780:4': wavelength -5 nm: must be finite and positive"},
      {"380:inf:4", "bands '380:inf:4': wavelength inf nm: must be finite and positive"},
      {"380:1e999:4", "bands '380:1e999:4': wavelength inf nm: must be finite and positive"},
      {"nan:780:4", "bands 'nan:780:4': wavelength nan nm: must be finite and positive"},
      {"500:500.00000000001:1000", "bands '500:500.00000000001:1000': the interval is empty"},
      {"400-410,", "bands '400-410,': an interval is missing"},
      {"400-410,,420-430", "bands '400-410,,420-430': an interval is missing"},
      {"410-400", "bands '410-400': '410-400': the interval is reversed: 410 nm is above 400 nm"},
      {"400-410, 5-5", "bands '400-410, 5-5': '5-5': the interval is empty"},
      {"400-x", "bands '400-x': 'x' is not a number"},
      {"400-410-420", "bands '400-410-420': '410-420' is not a number"},
      {"-400-410", "bands '-400-410': '-400-410': wavelength -400 nm: must be finite and positive"},
      {"400-410\n", "bands '400-410?': '410?' is not a number"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_EQ(error_of([&, t = text] { parse_channels(t); }), message) << text;
}

TEST(Channels, FileWithHeaderCommentsAndBlankLines) {
  const TemporaryFolder folder;
  const auto file = folder.write(
      "bands.csv", "\xEF\xBB\xBFmin_nm,max_nm\r\n# visible\r\n400,410 # first\r\n\r\n500 , 505.5\r\n");
  const ChannelList channels = read_channels_file(file);
  ASSERT_EQ(channels.size(), 2u);
  EXPECT_EQ(channels[0].max_nm, 410);
  EXPECT_EQ(channels[1].max_nm, 505.5);
}

TEST(Channels, FileInItsOwnUnit) {
  const TemporaryFolder folder;
  const auto first = [&](const std::string& text) {
    return read_channels_file(folder.write("f.csv", text))[0];
  };
  EXPECT_EQ(first("min_um,max_um\n8,12\n").max_nm, 12000);
  EXPECT_EQ(first("# wavelength in microns\n8,12\n").min_nm, 8000);
  EXPECT_EQ(first("from (cm-1),to (cm-1)\n1000,1250\n").min_nm, 8000);
  EXPECT_EQ(first("min,max\n8,12\n# the next one has 5 um\n12,13\n").max_nm, 12);
}

TEST(Channels, FileErrorsNameTheLine) {
  const TemporaryFolder folder;
  const std::pair<const char*, const char*> cases[] = {
      {"", "f.csv: no channels"},
      {"min,max\n", "f.csv: no channels"},
      {"400,410\n420\n", "f.csv:2: must be MIN,MAX"},
      {"400,410,5\n", "f.csv:1: must be MIN,MAX"},
      {"400,410\nmin,max\n", "f.csv:2: 'min' is not a number"},
      {"min,410\n", "f.csv:1: 'min' is not a number"},
      {"400,410\n430,420\n", "f.csv:2: the interval is reversed: 430 nm is above 420 nm"},
      {"400,nan\n", "f.csv:1: wavelength nan nm: must be finite and positive"},
  };
  for (const auto& [content, message] : cases) {
    const auto file = folder.write("f.csv", content);
    EXPECT_EQ(error_of(folder, [&] { read_channels_file(file); }), message) << content;
  }
  EXPECT_EQ(error_of(folder, [&] { read_channels_file(folder.path() / "no.csv"); }),
            "no.csv: cannot be opened: no such file");
  EXPECT_EQ(error_of([&] { read_channels_file(folder.path()); }),
            folder.path().string() + ": is not a regular file");
}

}  // namespace
}  // namespace kiloband::test
