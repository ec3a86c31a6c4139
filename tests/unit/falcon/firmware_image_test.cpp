#include "drivers/falcon/firmware_image.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstdio>
#include <string>
#include <string_view>
#include <thread>

#include "drivers/falcon/falcon_wire.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::falcon {
namespace {

using testing_support::TemporaryFolder;

std::string image_text(std::size_t size = 300) {
  std::string text(size, '\0');
  text[0] = '\xaa';
  text[1] = '\x08';
  for (std::size_t i = 40; i < size; ++i) text[i] = static_cast<char>(i * 7);
  return text;
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// FIPS 180-2, appendix B.1, and the sum of nothing.
TEST(FirmwareImage, SumsAreSha256) {
  EXPECT_EQ(sha256_of(bytes_of("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of({}), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(FirmwareImage, IsTakenWhenItsSumIsTheOneThatIsMeant) {
  const TemporaryFolder folder;
  const std::string text = image_text();
  const std::string path = folder.write("falcon.bin", text);
  std::string sum = sha256_of(bytes_of(text));
  const auto image = load_image(path, sum);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_TRUE(std::equal(image->begin(), image->end(), bytes_of(text).begin()));
  std::transform(sum.begin(), sum.end(), sum.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  EXPECT_TRUE(load_image(path, sum)) << "capitals are the same number";
}

TEST(FirmwareImage, IsRefusedWhenOneBitOfItDiffers) {
  const TemporaryFolder folder;
  std::string text = image_text();
  const std::string sum = sha256_of(bytes_of(text));
  text[200] = static_cast<char>(text[200] ^ 1);
  const auto image = load_image(folder.write("falcon.bin", text), sum);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, Errc::Malformed);
  EXPECT_NE(image.error().message.find(sha256_of(bytes_of(text))), std::string::npos)
      << image.error().message;
}

TEST(FirmwareImage, WithoutASumOnlyWhatIsPubliclyKnownIsTaken) {
  const TemporaryFolder folder;
  const auto image = load_image(folder.write("falcon.bin", image_text()), "");
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, Errc::Malformed);
  EXPECT_NE(image.error().message.find("firmware_sha256"), std::string::npos);
}

TEST(FirmwareImage, AMissingFileIsMissedWithTheWayToGetIt) {
  const TemporaryFolder folder;
  const auto image = load_image(folder / "none.bin", "");
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, Errc::NotFound);
  EXPECT_NE(image.error().message.find("nvent_firmware.bin"), std::string::npos);
  EXPECT_NE(image.error().message.find("libnifalcon"), std::string::npos);
}

TEST(FirmwareImage, OnlyARegularFileIsRead) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : {pipe, folder.path().string(), std::string("/dev/zero")}) {
    const auto image = load_image(path, "");
    ASSERT_FALSE(image) << path;
    EXPECT_EQ(image.error().code, Errc::NotFound) << path;
  }
}

// Whoever may write the folder can put a pipe there after any look at the name: then opening it
// would never return.
TEST(FirmwareImage, IsNotWaitedForWhereAPipeTakesItsPlace) {
  const TemporaryFolder folder;
  const std::string text = image_text();
  const std::string path = folder.write("falcon.bin", text);
  const std::string sum = sha256_of(bytes_of(text));
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::atomic<bool> is_done{false};
  std::thread stranger([&] {
    while (!is_done) ::renameat2(AT_FDCWD, path.c_str(), AT_FDCWD, pipe.c_str(), RENAME_EXCHANGE);
  });
  for (int i = 0; i < 20000; ++i) {
    const auto image = load_image(path, sum);
    if (!image) {
      EXPECT_EQ(image.error().code, Errc::NotFound) << image.error().message;
    }
  }
  is_done = true;
  stranger.join();
}

TEST(FirmwareImage, NoMoreThanItsBoundIsRead) {
  const TemporaryFolder folder;
  const std::string most = image_text(kMaxImageBytes);
  EXPECT_TRUE(load_image(folder.write("most.bin", most), sha256_of(bytes_of(most))));
  const std::string more = image_text(kMaxImageBytes + 1);
  const auto image = load_image(folder.write("more.bin", more), sha256_of(bytes_of(more)));
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, Errc::TooLarge);
}

TEST(FirmwareImage, WhatDoesNotBeginAsOneIsNone) {
  const TemporaryFolder folder;
  for (const std::string& text : {std::string(), std::string("\xaa"), std::string(300, 'x')}) {
    const auto image = load_image(folder.write("x.bin", text), sha256_of(bytes_of(text)));
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().code, Errc::Malformed);
  }
}

TEST(FirmwareImage, ASumThatCannotBeIsRefusedBeforeTheFileIsOpened) {
  for (const std::string& sum : {std::string("abc"), std::string(63, '0'), std::string(65, '0'),
                                 std::string(63, '0') + "g"}) {
    const auto image = load_image("/nowhere", sum);
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().code, Errc::InvalidArgument) << sum;
  }
}

}  // namespace
}  // namespace thimble::falcon
