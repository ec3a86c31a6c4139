#include "daemon/world/io/nrrd_header.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace thimble::world {
namespace {

constexpr const char* kPlain =
    "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 2 3 4\nendian: little\nencoding: raw\n";

Result<NrrdHeader> with(const std::string& more) {
  return parse_nrrd_header(kPlain + more + "\n", true);
}
std::string error_of(const Result<NrrdHeader>& sut) {
  return sut ? "no error" : sut.error().message;
}

// kPlain with one of its fields put differently; "" leaves it out.
Result<NrrdHeader> instead(const std::string& field, const std::string& line) {
  std::string text = kPlain;
  const auto start = text.find("\n" + field + ":") + 1;
  text.replace(start, text.find('\n', start) + 1 - start, line);
  return parse_nrrd_header(text + "\n", true);
}

TEST(NrrdHeader, TellsWhatItSays) {
  const auto sut = with("");
  ASSERT_TRUE(sut) << error_of(sut);
  EXPECT_EQ(sut->type, (ItemType{ItemKind::Unsigned, 2, false}));
  EXPECT_EQ(sut->encoding, NrrdEncoding::Raw);
  EXPECT_EQ(sut->sizes, (std::array<std::uint32_t, 3>{2, 3, 4}));
  EXPECT_FALSE(sut->spacing);
  EXPECT_EQ(sut->data_file, "");
  EXPECT_EQ(sut->header_bytes, std::string(kPlain).size() + 1);
}

TEST(NrrdHeader, EndsAtTheFirstBlankLine) {
  const std::string text = std::string(kPlain) + "\n";
  EXPECT_EQ(parse_nrrd_header(text + "sizes: 9\n\n", false)->header_bytes, text.size());
  std::string carriage;
  for (const char c : text) carriage += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(parse_nrrd_header(carriage + "\xff\xfe", true)->header_bytes, carriage.size());
}

TEST(NrrdHeader, OnlyADetachedOneMayEndWithTheFile) {
  EXPECT_EQ(error_of(parse_nrrd_header(kPlain, true)),
            "header: no blank line ends it within 65536 bytes");
  const std::string detached = std::string(kPlain) + "data file: a.raw";
  ASSERT_TRUE(parse_nrrd_header(detached, true));
  EXPECT_EQ(parse_nrrd_header(detached, true)->data_file, "a.raw");
  EXPECT_FALSE(parse_nrrd_header(detached, false));
}

TEST(NrrdHeader, KnowsEveryNameOfEveryType) {
  const auto type_of = [](const std::string& name) {
    const auto sut = instead("type", "type: " + name + "\n");
    return sut ? sut->type : ItemType{};
  };
  for (const auto& [names, kind, bytes] :
       {std::tuple{"signed char,int8,int8_t", ItemKind::Signed, 1U},
        std::tuple{"uchar,unsigned char,uint8,uint8_t,UNSIGNED  Char", ItemKind::Unsigned, 1U},
        std::tuple{"short,short int,signed short,signed short int,int16,int16_t", ItemKind::Signed,
                   2U},
        std::tuple{"ushort,unsigned short,unsigned short int,uint16,uint16_t", ItemKind::Unsigned,
                   2U},
        std::tuple{"int,signed int,int32,int32_t", ItemKind::Signed, 4U},
        std::tuple{"uint,unsigned int,uint32,uint32_t", ItemKind::Unsigned, 4U},
        std::tuple{"longlong,long long,long long int,signed long long,signed long long int,int64,"
                   "int64_t",
                   ItemKind::Signed, 8U},
        std::tuple{"ulonglong,unsigned long long,unsigned long long int,uint64,uint64_t",
                   ItemKind::Unsigned, 8U},
        std::tuple{"float", ItemKind::Float, 4U}, std::tuple{"double", ItemKind::Float, 8U}}) {
    std::string rest = std::string(names) + ",";
    for (; !rest.empty(); rest.erase(0, rest.find(',') + 1)) {
      const std::string name = rest.substr(0, rest.find(','));
      EXPECT_EQ(type_of(name), (ItemType{kind, bytes, false})) << name;
    }
  }
  EXPECT_EQ(error_of(instead("type", "type: block\n")),
            "type: 'block' is no integer of 8 to 64 bits, float or double");
}

TEST(NrrdHeader, KnowsTheEncodingsItReads) {
  const auto encoding_of = [](const char* name) {
    return instead("encoding", std::string("encoding: ") + name + "\n")->encoding;
  };
  for (const char* name : {"raw", "RAW"}) EXPECT_EQ(encoding_of(name), NrrdEncoding::Raw);
  for (const char* name : {"gzip", "gz"}) EXPECT_EQ(encoding_of(name), NrrdEncoding::Gzip);
  for (const char* name : {"text", "txt", "ascii"})
    EXPECT_EQ(encoding_of(name), NrrdEncoding::Text);
  EXPECT_EQ(instead("encoding", "encoding: bzip2\n").error().code, Errc::Unsupported);
  EXPECT_EQ(instead("encoding", "encoding: hex\n").error().code, Errc::Unsupported);
}

TEST(NrrdHeader, AsksForTheByteOrderWhereThereIsOne) {
  EXPECT_TRUE(instead("endian", "endian: BIG\n")->type.is_big_endian);
  EXPECT_EQ(error_of(instead("endian", "endian: middle\n")),
            "endian: expected little or big, found 'middle'");
  EXPECT_EQ(error_of(instead("endian", "")),
            "endian: is missing, and the items have more than one byte");
  const std::string rest = "dimension: 3\nsizes: 1 1 1\n";
  EXPECT_TRUE(parse_nrrd_header("NRRD0001\ntype: uchar\nencoding: raw\n" + rest + "\n", true));
  EXPECT_TRUE(parse_nrrd_header("NRRD0001\ntype: float\nencoding: text\n" + rest + "\n", true));
}

TEST(NrrdHeader, TakesSpacingFromEitherField) {
  EXPECT_EQ(*with("spacings: 1 0.5 +2e0\n")->spacing, (std::array{1.0, 0.5, 2.0}));
  EXPECT_FALSE(with("spacings: nan NaN nan\n")->spacing);
  const auto directions = with("space directions: (3,4,0) (0, -2, 0)  (0,0,0.25)\n");
  ASSERT_TRUE(directions) << error_of(directions);
  EXPECT_EQ(*directions->spacing, (std::array{5.0, 2.0, 0.25}));
  EXPECT_TRUE(with("axis mins: 0 0 0\n")->has_axis_bounds);
  EXPECT_FALSE(with("axis mins: 0 0 0\n")->spacing);
}

TEST(NrrdHeader, RefusesSpacingThatIsNone) {
  for (const char* bad :
       {"spacings: 1 1", "spacings: 1 1 0", "spacings: 1 1 -1", "spacings: 1 inf 1",
        "spacings: 1 1 nan", "spacings: 1 x 1", "space directions: (1,0,0) (0,1,0)",
        "space directions: (1,0,0) (0,1,0) (0,0,0)", "space directions: (1,0,0) (0,1,0) none",
        "space directions: (1,0,0) (0,1,0) (0,0,1) (1,1,1)", "space directions: (1,,0) (1) (1)",
        "space directions: () (1) (1)", "space directions: (1.7e308,1.7e308,1) (1) (1)",
        "spacings: 1 1 1\nspace directions: (1) (1) (1)"}) {
    EXPECT_FALSE(with(std::string(bad) + "\n")) << bad;
  }
}

TEST(NrrdHeader, RefusesWhatIsNoGridOfNumbers) {
  EXPECT_EQ(error_of(instead("dimension", "dimension: 4\n")), "dimension: is 4, expected 3");
  EXPECT_EQ(error_of(instead("dimension", "")), "sizes: come before dimension");
  EXPECT_EQ(error_of(instead("sizes", "sizes: 2 3\n")), "sizes: has 2 entries, expected 3");
  EXPECT_EQ(error_of(instead("sizes", "sizes: 2 0 3\n")),
            "sizes[1]: is 0; a world has at least 1 cell along each axis");
  for (const char* huge : {"1025", "4294967297", "99999999999999999999999"}) {
    const auto sut = instead("sizes", std::string("sizes: ") + huge + " 3 4\n");
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error(), (Error{Errc::TooLarge,
                                  std::string("sizes[0]: ") + huge + " cells; the limit is 1024"}));
  }
  for (const char* bad : {"sizes: -2 3 4\n", "sizes: 2.0 3 4\n", "sizes: x 3 4\n"}) {
    EXPECT_EQ(instead("sizes", bad).error().code, Errc::Malformed) << bad;
  }
  EXPECT_EQ(error_of(with("kinds: RGB-color domain domain\n")),
            "kinds: 'RGB-color' is no axis in space");
  EXPECT_TRUE(with("kinds: domain space ???\n"));
}

TEST(NrrdHeader, NamesWhatIsMissingTwiceOrUnknown) {
  for (const char* field : {"type", "sizes", "encoding"}) {
    EXPECT_EQ(error_of(instead(field, "")), std::string(field) + ": is missing");
  }
  EXPECT_EQ(error_of(with("type: float\n")), "type: comes twice");
  EXPECT_EQ(error_of(with("byteskip: 1\nByte Skip: 2\n")), "byte skip: comes twice");
  EXPECT_EQ(error_of(with("colour: red\n")), "header: unknown field 'colour'");
  EXPECT_EQ(error_of(with("no colon here\n")),
            "header: 'no colon here' is neither a field, a key nor a comment");
}

TEST(NrrdHeader, PassesOverCommentsKeysAndWhatNoFingerFeels) {
  EXPECT_TRUE(
      with("# anything: at all\nSegment0_Name:=bone: hard\ncontent:\nspace: scanner-xyz\n"
           "space origin: (0,0,0)\nlabels: \"a b\" \"\" \"\"\ncenterings: cell cell cell\n"));
}

TEST(NrrdHeader, BoundsWhatIsSkipped) {
  EXPECT_EQ(with("line skip: 3\nbyte skip: 512\n")->line_skip, 3U);
  EXPECT_EQ(with("byte skip: 512\n")->byte_skip, 512);
  EXPECT_EQ(with("byte skip: -1\n")->byte_skip, -1);
  for (const char* bad : {"line skip: -1", "line skip: 1000001", "line skip: 1 2", "byte skip: -2",
                          "byte skip: 1099511627777", "byte skip: 99999999999999999999"}) {
    EXPECT_EQ(with(std::string(bad) + "\n").error().code, Errc::Malformed) << bad;
  }
  EXPECT_FALSE(instead("encoding", "encoding: gzip\nbyte skip: -1\n"));
}

TEST(NrrdHeader, ADataFileStaysInTheFolderOfItsHeader) {
  for (const char* good :
       {"a.raw", "./a.raw", "sub/a.raw", "two words.raw", "..raw", "listed.raw"}) {
    EXPECT_EQ(with(std::string("data file: ") + good + "\n")->data_file, good);
  }
  EXPECT_EQ(with("data file:   a.raw  \n")->data_file, "a.raw");
  for (const char* bad : {"/etc/shadow", "../a.raw", "sub/../../a.raw", "sub/..", "LIST", "LIST 2",
                          "slice%03d.raw 0 9 1", "", "  ", "a\tb.raw"}) {
    EXPECT_FALSE(with(std::string("data file: ") + bad + "\n")) << bad;
  }
}

TEST(NrrdHeader, KnowsItsMagic) {
  const std::string rest = std::string(kPlain).substr(8) + "\n";
  for (const char version : std::string("12345")) {
    EXPECT_TRUE(parse_nrrd_header(std::string("NRRD000") + version + rest, true)) << version;
  }
  EXPECT_EQ(parse_nrrd_header("NRRD0006" + rest, true).error().code, Errc::Unsupported);
  EXPECT_EQ(parse_nrrd_header("NRRD00041" + rest, true).error().code, Errc::Unsupported);
  for (const char* bad : {"", "N", "NRRD0004", "\x93NUMPY", "nrrd0004\n"}) {
    EXPECT_FALSE(parse_nrrd_header(bad, true)) << bad;
  }
}

TEST(NrrdHeader, AnEndlessHeaderIsNotReadToItsEnd) {
  std::string text = kPlain;
  while (text.size() < 2 * kNrrdMaxHeaderBytes) text += "# again\n";
  EXPECT_EQ(error_of(parse_nrrd_header(text + "\n", true)),
            "header: no blank line ends it within 65536 bytes");
}

TEST(NrrdHeader, IsTotalUnderRandomDamage) {
  std::mt19937 random(7);
  const std::string good =
      std::string(kPlain) + "spacings: 1 2 3\nkinds: domain domain domain\nbyte skip: 7\n\n";
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text = good;
    for (auto n = 1 + random() % 3; n > 0; --n)
      text[random() % text.size()] = static_cast<char>(random());
    const auto sut = parse_nrrd_header(text, random() % 2 == 0);
    if (sut) {
      for (const std::uint32_t size : sut->sizes) ASSERT_TRUE(size >= 1 && size <= 1024);
      ASSERT_LE(sut->header_bytes, text.size());
      continue;
    }
    ++refused;
    for (const char c : sut.error().message) ASSERT_TRUE(c >= ' ' && c <= '~') << text;
  }
  EXPECT_GT(refused, 5000);
}

}  // namespace
}  // namespace thimble::world
