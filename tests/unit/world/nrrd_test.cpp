#include "daemon/world/io/nrrd.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <regex>
#include <string>

#include "tests/unit/world/grids.hpp"
#include "tests/unit/world/npy_bytes.hpp"
#include "tests/unit/world/nrrd_bytes.hpp"
#include "tests/unit/world/nrrd_cell.hpp"

namespace thimble::world {
namespace {

Result<std::unique_ptr<ByteSource>> no_data_file(const std::string& name) {
  return fail(Errc::NotFound, "data file: " + name);
}
Result<VoxelGrid> load(const std::string& file, const VolumeOptions& options = {}) {
  MemorySource source(bytes_of(file));
  return load_nrrd(source, no_data_file, options);
}
// A sentence that says where in the file, and then what.
bool names_a_field(const std::string& error) {
  static const std::regex kSentence(
      "(magic|header|type|dimension|sizes|encoding|endian|spacings|space directions|kinds|line "
      "skip|"
      "byte skip|data|data file)(\\[[012]\\])?: .+");
  return std::regex_match(error, kSentence);
}

TEST(Nrrd, TheFirstAxisRunsFastestAndIsX) { expect_one_cell(load(one_cell().file())); }

TEST(Nrrd, ReadsGzip) {
  NrrdBytes bytes = one_cell();
  bytes.encoding = "gzip";
  const std::string plain = bytes.data;
  bytes.data = gzipped(plain);
  expect_one_cell(load(bytes.file()));
  bytes.data = gzipped(plain.substr(0, 7)) + gzipped("") + gzipped(plain.substr(7));
  expect_one_cell(load(bytes.file()));
}

TEST(Nrrd, ReadsText) {
  NrrdBytes bytes = one_cell();
  bytes.encoding = "ascii";
  std::string text;
  for (const char c : bytes.data) text += c != 0 ? " \r\n1" : "\t0";
  bytes.data = text + "\n\n";
  expect_one_cell(load(bytes.file()));
  bytes.type = "double";
  bytes.more = "endian: big\n";
  expect_one_cell(load(bytes.file()));
}

template <class T>
std::string item(T value, bool is_big_endian) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (is_big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

template <class T>
void expect_above(const char* type, T below, T above) {
  for (const bool is_big : {false, true}) {
    NrrdBytes bytes;
    bytes.type = type;
    bytes.sizes = "2 1 1";
    bytes.more = is_big ? "endian: big\n" : "endian: little\n";
    bytes.data = item(below, is_big) + item(above, is_big);
    const auto sut = load(bytes.file(), {.threshold = 1});
    ASSERT_TRUE(sut) << type << error_of(sut);
    EXPECT_FALSE(sut->is_occupied({0, 0, 0})) << type;
    EXPECT_TRUE(sut->is_occupied({1, 0, 0})) << type;
  }
}

TEST(Nrrd, ReadsEveryTypeInBothByteOrders) {
  expect_above<std::int8_t>("int8", -1, 2);
  expect_above<std::uint8_t>("uchar", 1, 255);
  expect_above<std::int16_t>("short", -512, 512);
  expect_above<std::uint16_t>("ushort", 1, 0x8000);
  expect_above<std::int32_t>("int", -65536, 65536);
  expect_above<std::uint32_t>("uint", 0, 0x80000000U);
  expect_above<std::int64_t>("int64", INT64_MIN, INT64_MAX);
  expect_above<std::uint64_t>("uint64", 1, UINT64_MAX);
  expect_above<float>("float", 1.0F, 1.0001F);
  expect_above<double>("double", 1.0, 1.0 + 1e-12);
}

TEST(Nrrd, SkipsLinesThenBytes) {
  NrrdBytes bytes = one_cell();
  bytes.more = "line skip: 2\nbyte skip: 3\n";
  bytes.data = "P5\n# a line\nxyz" + bytes.data;
  expect_one_cell(load(bytes.file()));
  bytes.more = "byte skip: -1\n";
  expect_one_cell(load(bytes.file()));
  bytes.data = one_cell().data;
  expect_one_cell(load(bytes.file()));
  bytes.more = "line skip: 9\n";
  EXPECT_EQ(error_of(load(bytes.file())),
            "line skip: the data file has 0 lines to skip, expected 9");
}

TEST(Nrrd, SkipsLinesBeforeAndBytesAfterUnpacking) {
  NrrdBytes bytes = one_cell();
  bytes.encoding = "gz";
  bytes.more = "line skip: 1\nbyte skip: 100000\n";
  bytes.data = "a line\n" + gzipped(std::string(100000, 'x') + bytes.data);
  expect_one_cell(load(bytes.file()));
  bytes.more = "byte skip: 1000\n";
  bytes.data = gzipped("short") + std::string(8, 'x');
  EXPECT_EQ(error_of(load(bytes.file())), "data: gzip: other bytes follow behind its end");
  bytes.data = gzipped("short");
  EXPECT_EQ(error_of(load(bytes.file())), "byte skip: the data has 5 bytes to skip, expected 1000");
}

TEST(Nrrd, TakesSpacingFromTheFileUnlessTold) {
  NrrdBytes bytes;
  bytes.more = "space directions: (0,1,0) (1,0,0) (0,0,2)\n";
  EXPECT_EQ(load(bytes.file())->cells(), (std::array<std::uint32_t, 3>{2, 3, 8}));
  EXPECT_EQ(load(bytes.file(), {.spacing = std::array{1.0, 1.0, 1.0}})->cells(),
            (std::array<std::uint32_t, 3>{2, 3, 4}));
  bytes.more = "axis maxs: 1 2 3\n";
  EXPECT_EQ(load(bytes.file()).error().code, Errc::Unsupported);
  EXPECT_TRUE(load(bytes.file(), {.spacing = std::array{1.0, 1.0, 1.0}}));
}

TEST(Nrrd, RefusesEveryOtherLength) {
  for (const char* encoding : {"raw", "gzip", "text"}) {
    NrrdBytes bytes;
    bytes.encoding = encoding;
    if (bytes.encoding == "gzip") bytes.data = gzipped(bytes.data);
    if (bytes.encoding == "text") {
      bytes.data = "0";
      for (int i = 1; i < 24; ++i) bytes.data += " 0";
    }
    const std::string file = bytes.file();
    ASSERT_TRUE(load(file)) << error_of(load(file));
    for (std::size_t length = 0; length < file.size(); ++length) {
      const std::string error = error_of(load(file.substr(0, length)));
      ASSERT_TRUE(names_a_field(error)) << encoding << " " << length << ": " << error;
      // The header whole, it is the data that lack.
      ASSERT_TRUE(length < bytes.header().size() || error.starts_with("data: ")) << error;
    }
    const std::string longer = error_of(load(file + (bytes.encoding == "text" ? " 0" : "0")));
    EXPECT_TRUE(longer.starts_with("data: ")) << encoding << ": " << longer;
  }
}

TEST(Nrrd, SaysWhatTheDataLacks) {
  NrrdBytes bytes;
  bytes.data.pop_back();
  EXPECT_EQ(error_of(load(bytes.file())), "data: the file has 23 bytes for it, sizes ask for 24");
  bytes.encoding = "text";
  EXPECT_EQ(error_of(load(bytes.file())),
            "data: the file has 23 bytes for it, sizes ask for at least 47");
  bytes.data = std::string(50, ' ') + "0 1 1.5";
  EXPECT_EQ(error_of(load(bytes.file())),
            "data: number 3: expected a uint8, whole from 0 to 255, found '1.5'");
  bytes.data = std::string(50, ' ') + "0 1 256";
  EXPECT_EQ(error_of(load(bytes.file())),
            "data: number 3: expected a uint8, whole from 0 to 255, found '256'");
  bytes.data = std::string(50, ' ') + "0 1";
  EXPECT_EQ(error_of(load(bytes.file())), "data: number 3 of 24 is missing");
  bytes.data = std::string(50, ' ') + std::string(200000, '1');
  EXPECT_EQ(
      error_of(load(bytes.file())),
      "data: number 1: expected a uint8, whole from 0 to 255, found '111111111111111111111111...'");
}

TEST(Nrrd, SaysWhatPackedDataLack) {
  NrrdBytes bytes;
  bytes.encoding = "gzip";
  bytes.type = "short";
  bytes.more = "endian: little\n";
  bytes.data = gzipped(std::string(47, '\0'));
  EXPECT_EQ(error_of(load(bytes.file())), "data: ends after 47 bytes, its numbers take 48");
  bytes.sizes = "100 100 4";
  bytes.data = gzipped(std::string(50000, '\0'));
  EXPECT_EQ(error_of(load(bytes.file())), "data: ends after 50000 bytes, its numbers take 80000");
}

TEST(Nrrd, ALengthIsNoneOnlyWhereItIsNone) {
  NrrdBytes bytes;
  const auto said_of = [&](const std::string& vector) {
    bytes.more = "space directions: " + vector + " (0,1,0) (0,0,1)\n";
    return error_of(load(bytes.file()));
  };
  const std::string field = "space directions[0]: ";
  EXPECT_EQ(said_of("(0,0,0)"), field + "has no length greater than 0");
  EXPECT_EQ(said_of("(1.7e308,1.7e308,0)"), field + "is longer than a number can say");
  // Its square is none that a number can say, but it has a length, which is far from the others.
  for (const char* vector : {"(1e308,1e308,0)", "(1e-200,0,0)"}) {
    EXPECT_EQ(said_of(vector).find("length"), std::string::npos) << said_of(vector);
    EXPECT_NE(said_of(vector), "none");
  }
  bytes.more = "space directions: (1e-200,0,0) (0,1e-200,0) (0,0,1e-200)\n";
  EXPECT_EQ(error_of(load(bytes.file())), "none");
}

TEST(Nrrd, AHugeClaimIsRefusedByLength) {
  for (const char* encoding : {"raw", "gzip", "text"}) {
    NrrdBytes bytes;
    bytes.type = "double";
    bytes.sizes = "1024 1024 1024";
    bytes.encoding = encoding;
    bytes.more = "endian: little\n";
    const auto sut = load(bytes.file());
    ASSERT_FALSE(sut);
    EXPECT_NE(error_of(sut).find("data: the file has 24 bytes for it"), std::string::npos);
  }
}

TEST(Nrrd, ABombIsUnpackedNoFurtherThanItsSizes) {
  NrrdBytes bytes;
  bytes.encoding = "gzip";
  bytes.data = gzipped(std::string(10000000, '\0'));
  EXPECT_EQ(error_of(load(bytes.file())), "data: holds more than the 24 bytes that sizes ask for");
}

TEST(Nrrd, SaysThatOtherBytesFollowPackedData) {
  NrrdBytes bytes = one_cell();
  bytes.encoding = "gzip";
  const std::string packed = gzipped(bytes.data);
  for (const std::string& rest :
       {std::string(600, '\0'), std::string("\x1f \x8b"), std::string("PK\3\4")}) {
    bytes.data = packed + rest;
    EXPECT_EQ(error_of(load(bytes.file())), "data: gzip: other bytes follow behind its end")
        << rest;
  }
}

TEST(Nrrd, SaysWhatATypeCanHold) {
  struct Case {
    const char* type;
    const char* number;
    const char* says;
  };
  for (const auto& [type, number, says] :
       {Case{"int8", "128", "an int8, whole from -128 to 127"},
        Case{"uint16", "-1", "a uint16, whole from 0 to 65535"},
        Case{"int64", "1e19", "an int64, whole from -9223372036854775808 to 9223372036854775807"},
        Case{"uint64", "2e19", "a uint64, whole from 0 to 18446744073709551615"},
        Case{"float", "one", "a float"}, Case{"double", "1,5", "a double"}}) {
    NrrdBytes bytes = one_cell();
    bytes.type = type;
    bytes.encoding = "text";
    bytes.data = std::string(50, ' ') + number;
    EXPECT_EQ(error_of(load(bytes.file())),
              std::string("data: number 1: expected ") + says + ", found '" + number + "'");
  }
}

TEST(Nrrd, DamagedGzipIsAnError) {
  NrrdBytes bytes = one_cell();
  bytes.encoding = "gzip";
  bytes.data = gzipped(bytes.data);
  std::string damaged = bytes.file();
  damaged[damaged.size() - 6] ^= 1;  // in the checksum
  EXPECT_EQ(error_of(load(damaged)), "data: gzip: incorrect data check");
  bytes.data = std::string(30, 'x');
  EXPECT_EQ(error_of(load(bytes.file())), "data: gzip: incorrect header check");
  std::mt19937 random(5);
  const std::string good = [] {
    NrrdBytes out = one_cell();
    out.encoding = "gzip";
    out.data = gzipped(out.data);
    return out.file();
  }();
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string file = good;
    file[random() % file.size()] = static_cast<char>(random());
    const auto sut = load(file);
    if (sut) {
      expect_one_cell(sut);
    } else {
      EXPECT_TRUE(names_a_field(error_of(sut))) << error_of(sut);
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(Nrrd, ReadsAVolumeOfManyChunks) {
  std::mt19937 random(41);
  NrrdBytes bytes;
  bytes.sizes = "50 60 70";
  bytes.data = std::string(50 * 60 * 70, '\0');
  for (char& c : bytes.data) c = random() % 2 == 0 ? '\1' : '\0';
  const std::string plain = bytes.data;
  for (const char* encoding : {"raw", "gzip", "text"}) {
    bytes.encoding = encoding;
    if (bytes.encoding == "gzip") bytes.data = gzipped(plain);
    if (bytes.encoding == "text") {
      bytes.data.clear();
      for (const char c : plain) bytes.data += c != 0 ? "1.0e0\n" : "-0 ";
    }
    const auto sut = load(bytes.file());
    ASSERT_TRUE(sut) << error_of(sut);
    for_each_cell(*sut, [&](Cell c) {
      ASSERT_EQ(sut->is_occupied(c),
                plain[static_cast<std::size_t>(c.x + 50 * (c.y + 60 * c.z))] != '\0');
    });
  }
}

}  // namespace
}  // namespace thimble::world
