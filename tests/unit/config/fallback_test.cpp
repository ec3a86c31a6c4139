#include <gtest/gtest.h>

#include <string>

#include "daemon/config/load.hpp"

namespace thimble::config {
namespace {

std::string arm(const std::string& lines) {
  return "[[arm]]\nname = \"right\"\nworld = \"box\"\n" + lines +
         "[[world]]\nname = \"box\"\nsource = \"box:3\"\n";
}

std::string mistake(const std::string& lines) {
  const ConfigResult sut = parse(arm(lines), "fallback.toml", {});
  return sut ? "" : to_string(sut.error().front());
}

TEST(ConfigFirmware, OfASumThatCanBeNoFilesIsRefused) {
  for (const std::string sum : {"", "00ff", "xyz"}) {
    EXPECT_NE(mistake("device = \"usb:1-4\"\nfirmware_sha256 = \"" + sum + "\"\n")
                  .find("arm.0.firmware_sha256"),
              std::string::npos)
        << sum;
  }
  EXPECT_EQ(mistake("device = \"usb:1-4\"\nfirmware_sha256 = \"" + std::string(64, 'a') + "\"\n"),
            "");
}

TEST(ConfigFallback, IsOfARealDeviceAndBringsAPerson) {
  const ConfigResult sut =
      parse(arm("device = \"hid:A\"\nmodel = \"woody-2015\"\nfallback = \"simulated\"\n"
                "[arm.hand]\nseed = 3\n"),
            "fallback.toml", {});
  ASSERT_TRUE(sut) << to_string(sut.error().front());
  EXPECT_EQ(sut->arms[0].fallback, Fallback::Simulated);
  ASSERT_TRUE(sut->arms[0].hand);
  EXPECT_EQ(sut->arms[0].hand->seed, 3U);
}

TEST(ConfigFallback, IsNothingUnlessItIsSaid) {
  const ConfigResult sut = parse(arm("device = \"hid:A\"\n"), "fallback.toml", {});
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->arms[0].fallback, Fallback::None);
  EXPECT_FALSE(sut->arms[0].hand);
}

TEST(ConfigFallback, NamesWhatIsWrongWithIt) {
  EXPECT_NE(mistake("device = \"sim:woody-2015\"\nfallback = \"simulated\"\n").find("real device"),
            std::string::npos);
  EXPECT_NE(mistake("device = \"hid:A\"\nfallback = \"simulated\"\n").find("beside model"),
            std::string::npos);
  EXPECT_NE(mistake("device = \"hid:A\"\nfallback = \"real\"\n").find("\"simulated\""),
            std::string::npos);
  EXPECT_NE(mistake("device = \"hid:A\"\n[arm.hand]\nseed = 3\n").find("\"sim:\""),
            std::string::npos);
}

}  // namespace
}  // namespace thimble::config
