#include "daemon/world/io/npy.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/unit/world/grids.hpp"
#include "tests/unit/world/npy_bytes.hpp"
#include "tests/unit/world/volume_files.hpp"

namespace thimble::world {
namespace {

Result<VoxelGrid> load(const std::string& file, VolumeOptions options = {}) {
  MemorySource source(bytes_of(file));
  return load_npy(source, options);
}

template <class T>
std::string item(T value, bool is_big_endian) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (is_big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

TEST(Npy, IndexesVolumeXYZInBothOrders) {
  for (const bool is_fortran : {false, true}) {
    NpyBytes bytes;
    bytes.fortran_order = is_fortran ? "True" : "False";
    const std::size_t at = is_fortran ? 1 + 2 * (2 + 3 * 3) : 3 + 4 * (2 + 3 * 1);  // [1, 2, 3]
    bytes.data[at] = 1;
    const auto one = load(bytes.file());
    ASSERT_TRUE(one);
    for_each_cell(*one, [&](Cell c) { EXPECT_EQ(one->is_occupied(c), c == (Cell{1, 2, 3})); });
    bytes.data = std::string(24, '\0');
    const std::size_t other = is_fortran ? 0 + 2 * (1 + 3 * 2) : 2 + 4 * (1 + 3 * 0);  // [0, 1, 2]
    bytes.data[other] = 1;
    EXPECT_TRUE(load(bytes.file())->is_occupied({0, 1, 2}));
  }
}

TEST(Npy, AHeaderTooShortToHoldAnythingIsRefused) {
  const std::string file =
      std::string("\x93NUMPY\x01\x00\x01\x00", 10) + "\n" + std::string(9, 'x');
  const auto sut = load(file);
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::Malformed);
  EXPECT_EQ(sut.error().message, "header length: too small to hold a header");
}

TEST(Npy, TheLongestAxisSpansTheWorkspaceWithCubes) {
  const auto sut = load(NpyBytes{}.file(), {0.08, 0});
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->cells(), (std::array<std::uint32_t, 3>{2, 3, 4}));
  EXPECT_DOUBLE_EQ(sut->cell_m(), 0.02);
}

template <class T>
void expect_occupied(const char* descr, T value, bool expected) {
  for (const bool is_big_endian : {false, true}) {
    NpyBytes bytes;
    bytes.descr = std::string("'") + (is_big_endian ? ">" : "<") + descr + "'";
    bytes.shape = "(1, 1, 1)";
    bytes.data = item(value, is_big_endian);
    const auto sut = load(bytes.file());
    ASSERT_TRUE(sut) << sut.error().message;
    EXPECT_EQ(sut->is_occupied({0, 0, 0}), expected) << bytes.descr << " " << +value;
  }
}

TEST(Npy, OccupiedIsWhatIsGreaterThanZeroInEveryType) {
  expect_occupied<std::uint8_t>("b1", 1, true);
  expect_occupied<std::uint8_t>("b1", 0, false);
  expect_occupied<std::int8_t>("i1", -1, false);
  expect_occupied<std::int8_t>("i1", 1, true);
  expect_occupied<std::uint8_t>("u1", 255, true);
  expect_occupied<std::int16_t>("i2", -256, false);
  expect_occupied<std::uint16_t>("u2", 0xFF00, true);
  expect_occupied<std::int32_t>("i4", -65536, false);
  expect_occupied<std::uint32_t>("u4", 0x80000000U, true);
  expect_occupied<std::int64_t>("i8", INT64_MIN, false);
  expect_occupied<std::int64_t>("i8", 1LL << 40, true);
  expect_occupied<std::uint64_t>("u8", UINT64_MAX, true);
  expect_occupied<float>("f4", 1e-40F, true);
  expect_occupied<float>("f4", -0.0F, false);
  expect_occupied<double>("f8", 1e-300, true);
  expect_occupied<double>("f8", -HUGE_VAL, false);
  expect_occupied<double>("f8", HUGE_VAL, true);
  expect_occupied<std::uint16_t>("f2", 0x0001, true);   // the smallest half
  expect_occupied<std::uint16_t>("f2", 0x8000, false);  // -0
  expect_occupied<std::uint16_t>("f2", 0xBC00, false);  // -1
  expect_occupied<std::uint16_t>("f2", 0x7C00, true);   // infinity
}

TEST(Npy, TheThresholdCounts) {
  NpyBytes bytes;
  bytes.descr = "'<f2'";
  bytes.shape = "(1, 1, 3)";
  bytes.data = item<std::uint16_t>(0x3800, false) + item<std::uint16_t>(0x3801, false) +
               item<std::uint16_t>(0x37FF, false);  // 0.5, just above, just below
  const auto sut = load(bytes.file(), {0.09, 0.5});
  ASSERT_TRUE(sut);
  EXPECT_FALSE(sut->is_occupied({0, 0, 0}));
  EXPECT_TRUE(sut->is_occupied({0, 0, 1}));
  EXPECT_FALSE(sut->is_occupied({0, 0, 2}));
}

TEST(Npy, RefusesNaNAndNamesItsPlace) {
  NpyBytes bytes;
  bytes.descr = "'<f4'";
  bytes.shape = "(1, 2, 2)";
  bytes.data = item(0.F, false) + item(0.F, false) + item(0.F, false) + item(NAN, false);
  const auto sut = load(bytes.file());
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().message, "volume[0, 1, 1]: is not a number");
  bytes.descr = "'<f2'";
  bytes.data = std::string(6, '\0') + item<std::uint16_t>(0x7E00, false);
  EXPECT_FALSE(load(bytes.file()));
}

TEST(Npy, ReadsAVolumeOfManyChunks) {
  std::mt19937 random(40);
  NpyBytes bytes;
  bytes.shape = "(50, 60, 70)";
  bytes.data = std::string(50 * 60 * 70, '\0');
  for (char& c : bytes.data) c = random() % 2 == 0 ? '\1' : '\0';
  const auto sut = load(bytes.file());
  ASSERT_TRUE(sut);
  for_each_cell(*sut, [&](Cell c) {
    ASSERT_EQ(sut->is_occupied(c),
              bytes.data[static_cast<std::size_t>(c.z + 70 * (c.y + 60 * c.x))] != '\0');
  });
}

TEST(Npy, RefusesEveryOtherLength) {
  const std::string file = NpyBytes{}.file();
  ASSERT_TRUE(load(file));
  for (std::size_t length = 0; length < file.size(); ++length) {
    ASSERT_FALSE(load(file.substr(0, length))) << length;
  }
  const auto longer = load(file + '\0');
  ASSERT_FALSE(longer);
  EXPECT_EQ(longer.error().message, "data: the file has 153 bytes, header and shape ask for 152");
}

// Says it holds more than it does, as a file that shrinks while it is read.
class ShrinkingSource final : public ByteSource {
 public:
  explicit ShrinkingSource(const std::string& file)
      : size_(file.size()), inner_(bytes_of(file).first(file.size() - 1)) {}
  [[nodiscard]] std::uint64_t size() const noexcept override { return size_; }
  [[nodiscard]] Result<std::size_t> read(std::span<std::byte> out) override {
    return inner_.read(out);
  }

 private:
  std::uint64_t size_;
  MemorySource inner_;
};

TEST(Npy, AFileThatShrinksMeanwhileIsAnError) {
  const std::string file = NpyBytes{}.file();
  ShrinkingSource source(file);
  EXPECT_EQ(load_npy(source, {}).error().message, "data: ends after 23 bytes, its numbers take 24");
}

// A length that is a lie never costs memory: refused before any cell is kept.
TEST(Npy, AHugeShapeWithoutDataIsRefusedByLength) {
  NpyBytes bytes;
  bytes.descr = "'<f8'";
  bytes.shape = "(1024, 1024, 1024)";
  const auto sut = load(bytes.file());
  ASSERT_FALSE(sut);
  EXPECT_NE(sut.error().message.find("8589934720"), std::string::npos) << sut.error().message;
}

TEST(Npy, RefusesAWorkspaceThatGivesNoCell) {
  EXPECT_EQ(load(NpyBytes{}.file(), {0, 0}).error().code, Errc::InvalidArgument);
}

class NpyFile : public VolumeFiles {};

TEST_F(NpyFile, ReadsAFile) {
  NpyBytes bytes;
  bytes.data[5] = 1;
  const auto sut = load_npy_file(write("a.npy", bytes.file()), {});
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(*sut, *load(bytes.file()));
}

TEST_F(NpyFile, NamesTheFileInFrontOfTheField) {
  const std::string path = write("a.npy", "nonsense");
  EXPECT_EQ(load_npy_file(path, {}).error(),
            (Error{Errc::Malformed, path + ": magic: not a NumPy .npy file"}));
}

TEST_F(NpyFile, RefusesWhatIsNoRegularFileWithoutWaiting) {
  const std::string fifo = folder + "/fifo.npy";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const std::string socket = folder + "/socket.npy";
  ASSERT_EQ(::mknod(socket.c_str(), S_IFSOCK | 0600, 0), 0);
  for (const auto& [path, kind] : {std::pair{fifo, "a FIFO"},
                                   {socket, "a socket"},
                                   {folder, "a directory"},
                                   {std::string("/dev/zero"), "a device"}}) {
    const auto sut = load_npy_file(path, {});
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error().message, path + ": is " + kind + ", expected a regular file");
  }
}

TEST_F(NpyFile, ANameThatTheSystemCannotFollowIsToldInItsWords) {
  const std::string path = folder + "/circle.npy";
  ASSERT_EQ(::symlink("circle.npy", path.c_str()), 0);
  const auto sut = load_npy_file(path, {});
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::System);
  EXPECT_EQ(sut.error().message, path + ": open: " + std::strerror(ELOOP));
}

TEST_F(NpyFile, TellsMissingFromForbidden) {
  EXPECT_EQ(load_npy_file(folder + "/none.npy", {}).error().code, Errc::NotFound);
  const std::string path = write("a.npy", NpyBytes{}.file());
  EXPECT_EQ(load_npy_file(path + "/below.npy", {}).error().code, Errc::NotFound);
  ASSERT_EQ(::chmod(path.c_str(), 0), 0);
  // Root may read everything, so it asks as nobody.
  const bool is_root = ::geteuid() == 0;
  ASSERT_EQ(::seteuid(is_root ? 65534 : ::geteuid()), 0);
  const auto sut = load_npy_file(path, {});
  ASSERT_EQ(::seteuid(is_root ? 0 : ::geteuid()), 0);
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::Permission);
}

}  // namespace
}  // namespace thimble::world
