#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <string>

#include "daemon/world/io/npy.hpp"
#include "daemon/world/io/nrrd.hpp"
#include "tests/unit/world/npy_bytes.hpp"
#include "tests/unit/world/nrrd_bytes.hpp"

// A disk that fails in the middle of a volume.
namespace thimble::world {
namespace {

// Gives what lies before `fails_at`; then the system refuses, once and for all.
class FailingSource final : public ByteSource {
 public:
  FailingSource(const std::string& bytes, std::size_t fails_at)
      : bytes_(bytes), fails_at_(fails_at) {}
  [[nodiscard]] std::uint64_t size() const noexcept override { return bytes_.size(); }
  [[nodiscard]] Result<std::size_t> read(std::span<std::byte> out) override {
    const std::size_t count = std::min(out.size(), bytes_.size() - at_);
    if (at_ + count > fails_at_) return fail(Errc::System, "read: the disk is gone");
    std::memcpy(out.data(), bytes_.data() + at_, count);
    at_ += count;
    return count;
  }

 private:
  const std::string& bytes_;
  std::size_t fails_at_;
  std::size_t at_{0};
};

// Longer than any look ahead, so that the failure may meet each step of reading.
constexpr std::size_t kSide = 48;
constexpr std::size_t kCells = kSide * kSide * kSide;

std::string random_cells() {
  std::mt19937 random(11);
  std::string cells(kCells, '\0');
  for (char& cell : cells) cell = static_cast<char>(random());
  return cells;
}

std::string nrrd(const char* encoding, const char* more, const std::string& data) {
  NrrdBytes bytes;
  bytes.sizes = "48 48 48";
  bytes.encoding = encoding;
  bytes.more = more;
  bytes.data = data;
  return bytes.file();
}

std::string text_nrrd() {
  std::string text;
  for (const char cell : random_cells()) text += cell < 0 ? "1 " : "0\n";
  return nrrd("text", "line skip: 1\nbyte skip: 3\n", "a line\nxyz" + text);
}

std::string npy() {
  NpyBytes bytes;
  bytes.shape = "(48, 48, 48)";
  bytes.data = random_cells();
  for (char& cell : bytes.data) cell = cell < 0 ? '\1' : '\0';
  return bytes.file();
}

struct Format {
  const char* name;
  std::string file;
};

std::vector<Format> formats() {
  return {{"npy", npy()},
          {"raw", nrrd("raw", "line skip: 1\n", "a line\n" + random_cells())},
          {"from the end", nrrd("raw", "byte skip: -1\n", "what is skipped" + random_cells())},
          {"gzip", nrrd("gzip", "", gzipped(random_cells()))},
          {"gzip, skipping",
           nrrd("gzip", "byte skip: 70000\n", gzipped(std::string(70000, 'x') + random_cells()))},
          {"text", text_nrrd()}};
}

Result<VoxelGrid> load(const Format& format, ByteSource& source) {
  if (std::string(format.name) == "npy") return load_npy(source, {});
  const auto none = [](const std::string& name) -> Result<std::unique_ptr<ByteSource>> {
    return fail(Errc::NotFound, name);
  };
  return load_nrrd(source, none, {});
}

TEST(FailingSource, AnywhereInAnyFormatIsToldAsWhatItIs) {
  std::mt19937 random(13);
  for (const Format& format : formats()) {
    FailingSource healthy(format.file, format.file.size());
    ASSERT_TRUE(load(format, healthy)) << format.name;

    for (int round = 0; round < 60; ++round) {
      // The header's bytes one by one, then anywhere.
      const std::size_t fails_at =
          round < 20 ? static_cast<std::size_t>(round) : random() % format.file.size();
      FailingSource source(format.file, fails_at);
      const auto sut = load(format, source);
      ASSERT_FALSE(sut) << format.name << " at " << fails_at;
      EXPECT_EQ(sut.error().code, Errc::System) << format.name << " at " << fails_at;
      EXPECT_NE(sut.error().message.find("the disk is gone"), std::string::npos)
          << format.name << " at " << fails_at << ": " << sut.error().message;
    }
  }
}

TEST(FailingSource, InTheFileThatADetachedHeaderNamesIsToldToo) {
  const std::string data = random_cells();
  const std::string header = nrrd("raw", "data file: cells.raw\n", "");
  for (const std::size_t fails_at : {std::size_t{0}, std::size_t{1}, kCells / 2, kCells - 1}) {
    FailingSource source(header, header.size());
    const auto sut = load_nrrd(source,
                               [&](const std::string&) -> Result<std::unique_ptr<ByteSource>> {
                                 return std::make_unique<FailingSource>(data, fails_at);
                               },
                               {});
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error().code, Errc::System) << sut.error().message;
  }
}

}  // namespace
}  // namespace thimble::world
