#include "daemon/link/link_key.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace thimble::link {
namespace {

namespace fs = std::filesystem;

const std::string kDigits = "000102030405060708090a0b0c0d0e0f101112131415161718191A1B1C1D1E1F";

Result<LinkKey> parsed(const std::string& text) {
  return parse_key(std::as_bytes(std::span(text)));
}

LinkKey counted() {
  std::array<std::byte, LinkKey::kSize> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::byte(i);
  return LinkKey(bytes);
}

class LinkKeyFileTest : public ::testing::Test {
 protected:
  [[nodiscard]] Result<LinkKey> load(const std::string& text, fs::perms permissions) const {
    const fs::path file = folder.write("key", text);
    fs::permissions(file, permissions);
    return load_key(file.string());
  }
  testing_support::TemporaryFolder folder;
};

TEST(LinkKeyTest, TakesSixtyFourDigitsOrThirtyTwoBytes) {
  for (const char* const end : {"", "\n", "\r\n"}) {
    const Result<LinkKey> key = parsed(kDigits + end);
    ASSERT_TRUE(key.has_value());
    EXPECT_EQ(*key, counted());
  }
  std::string raw;
  for (int i = 0; i < 32; ++i) raw.push_back(static_cast<char>(i));
  ASSERT_TRUE(parsed(raw).has_value());
  EXPECT_EQ(*parsed(raw), counted());
}

TEST(LinkKeyTest, RefusesEverythingElse) {
  const std::string digits = kDigits;
  for (const std::string& text :
       {std::string(), digits.substr(1), digits + "0", digits + "\n\n", digits + " ", "\n" + digits,
        digits.substr(0, 63) + "g", digits + digits, std::string(33, 'a')}) {
    const Result<LinkKey> key = parsed(text);
    ASSERT_FALSE(key.has_value()) << text;
    EXPECT_EQ(key.error().code, Errc::Malformed);
    EXPECT_NE(key.error().message.find("64 hexadecimal digits"), std::string::npos);
  }
}

TEST(LinkKeyTest, NoiseIsAKeyOnlyWhereItHasTheRightLength) {
  std::mt19937 random(8);
  for (int i = 0; i < 5000; ++i) {
    std::string noise(random() % 80, '\0');
    for (char& letter : noise) letter = static_cast<char>(random() & 0xFFU);
    EXPECT_EQ(parsed(noise).has_value(), noise.size() == 32);  // 64 digits do not come by chance
  }
}

TEST_F(LinkKeyFileTest, IsReadByItsOwnerAlone) {
  EXPECT_EQ(*load(kDigits + "\n", fs::perms::owner_read | fs::perms::owner_write), counted());
  EXPECT_TRUE(load(kDigits, fs::perms::owner_read).has_value());
  for (const fs::perms more :
       {fs::perms::group_read, fs::perms::others_read, fs::perms::group_write,
        fs::perms::others_write, fs::perms::others_exec}) {
    const Result<LinkKey> key =
        load(kDigits, fs::perms::owner_read | fs::perms::owner_write | more);
    ASSERT_FALSE(key.has_value());
    EXPECT_EQ(key.error().code, Errc::Permission);
    EXPECT_NE(key.error().message.find("chmod 600"), std::string::npos);
  }
}

TEST_F(LinkKeyFileTest, SaysWhatIsWrongWithTheFile) {
  EXPECT_EQ(load_key((folder / "nowhere").string()).error().code, Errc::NotFound);
  EXPECT_EQ(load_key(folder.path().string()).error().code, Errc::InvalidArgument);
  const Result<LinkKey> longer = load(kDigits + std::string(1000, '\n'), fs::perms::owner_read);
  EXPECT_EQ(longer.error().code, Errc::Malformed);
  EXPECT_NE(longer.error().message.find((folder / "key").string()), std::string::npos);
}

}  // namespace
}  // namespace thimble::link
