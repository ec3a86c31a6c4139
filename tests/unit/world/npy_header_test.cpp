#include "daemon/world/io/npy_header.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/world/npy_bytes.hpp"

namespace thimble::world {
namespace {

Error error_of(const std::string& text) {
  const auto sut = parse_npy_text(text);
  return sut ? Error{} : sut.error();
}

TEST(NpyHeader, ReadsWhatNumPyWrites) {
  const auto sut = parse_npy_text(
      "{'descr': '<f4', 'fortran_order': False, 'shape': (64, 32, 1024), }          \n");
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(*sut, (NpyHeader{ItemKind::Float, 4, false, false, {64, 32, 1024}}));
}

TEST(NpyHeader, TakesAnyOrderQuotesBlanksAndPythonTwoLongs) {
  const auto sut =
      parse_npy_text("\t{ \"shape\":(1L,2 , 3L),\n'fortran_order' :True,'descr':\">u2\"}");
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(*sut, (NpyHeader{ItemKind::Unsigned, 2, true, true, {1, 2, 3}}));
}

TEST(NpyHeader, KnowsEveryPlainType) {
  const std::pair<const char*, ItemKind> kinds[] = {
      {"b1", ItemKind::Bool},     {"i1", ItemKind::Signed},   {"i2", ItemKind::Signed},
      {"i4", ItemKind::Signed},   {"i8", ItemKind::Signed},   {"u1", ItemKind::Unsigned},
      {"u2", ItemKind::Unsigned}, {"u4", ItemKind::Unsigned}, {"u8", ItemKind::Unsigned},
      {"f2", ItemKind::Float},    {"f4", ItemKind::Float},    {"f8", ItemKind::Float}};
  for (const auto& [name, kind] : kinds) {
    for (const std::string prefix : {"<", ">", "|", "=", ""}) {
      NpyBytes bytes;
      bytes.descr = "'" + prefix + name + "'";
      const auto sut = parse_npy_text(bytes.text());
      ASSERT_TRUE(sut) << bytes.descr;
      EXPECT_EQ(sut->kind, kind);
      EXPECT_EQ(sut->item_bytes, static_cast<std::uint32_t>(name[1] - '0'));
      EXPECT_EQ(sut->is_big_endian, prefix == ">");
    }
  }
}

struct Damage {
  const char* descr;
  const char* order;
  const char* shape;
  Errc code;
  const char* names;  // what the message must say
};

TEST(NpyHeader, NamesFieldAndLimitOfEachDamage) {
  const Damage damages[] = {
      {"'|O'", "False", "(2, 3, 4)", Errc::Unsupported, "descr: '|O' (objects)"},
      {"'<c16'", "False", "(2, 3, 4)", Errc::Unsupported, "descr: '<c16'"},
      {"'<f16'", "False", "(2, 3, 4)", Errc::Unsupported, "descr: '<f16'"},
      {"'S5'", "False", "(2, 3, 4)", Errc::Unsupported, "descr: 'S5'"},
      {"''", "False", "(2, 3, 4)", Errc::Unsupported, "descr: ''"},
      {"[('a', '<f4')]", "False", "(2, 3, 4)", Errc::Unsupported, "descr: a structured type"},
      {"5", "False", "(2, 3, 4)", Errc::Malformed, "descr: expected a string"},
      {"'|b1", "False", "(2, 3, 4)", Errc::Unsupported, "descr"},
      {"'|b1'", "0", "(2, 3, 4)", Errc::Malformed, "fortran_order: expected True or False"},
      {"'|b1'", "False", "(2, 3, -4)", Errc::Malformed, "shape[2]: is negative"},
      {"'|b1'", "False", "(2, 0, 4)", Errc::Malformed, "shape[1]: is 0"},
      {"'|b1'", "False", "(1025, 3, 4)", Errc::TooLarge, "shape[0]: 1025 cells; the limit is 1024"},
      {"'|b1'", "False", "(2, 99999999999999999999999999, 4)", Errc::TooLarge,
       "shape[1]: 999999999999999999999999 cells; the limit is 1024"},
      {"'|b1'", "False", "(2, 3)", Errc::Unsupported, "shape: has 2 dimensions, expected 3"},
      {"'|b1'", "False", "()", Errc::Unsupported, "shape: has 0 dimensions, expected 3"},
      {"'|b1'", "False", "(1, 2, 3, 4)", Errc::Unsupported, "shape: has more than 3"},
      {"'|b1'", "False", "[2, 3, 4]", Errc::Malformed, "shape: expected a tuple"},
      {"'|b1'", "False", "(2, 3 4)", Errc::Malformed, "shape: expected , or )"},
      {"'|b1'", "False", "(2, x, 4)", Errc::Malformed, "shape[1]: expected a whole number"},
      {"'|b1'", "False", "(2, 3, 4.5)", Errc::Malformed, "shape: expected , or )"},
  };
  for (const Damage& damage : damages) {
    const NpyBytes bytes{damage.descr, damage.order, damage.shape, "", 1};
    const Error error = error_of(bytes.text());
    EXPECT_EQ(error.code, damage.code) << error.message;
    EXPECT_NE(error.message.find(damage.names), std::string::npos) << error.message;
  }
}

TEST(NpyHeader, RefusesWhatIsNotTheDict) {
  const std::string whole = NpyBytes{}.text();
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[]"), std::string("{}"), whole + "x",
        whole + whole, "{'extra': 1, " + whole.substr(1), "{'shape': (1, 1, 1), " + whole.substr(1),
        "{\\'descr\\': 1}" + whole, std::string(50, '\0'), std::string(60000, '(')}) {
    EXPECT_FALSE(parse_npy_text(text)) << text.substr(0, 40);
  }
  EXPECT_NE(error_of("{'descr': '|b1'}").message.find("'fortran_order' is missing"),
            std::string::npos);
}

TEST(NpyHeader, RefusesEveryTruncation) {
  const std::string whole = NpyBytes{}.text();
  ASSERT_TRUE(parse_npy_text(whole));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(parse_npy_text(std::string_view(whole).substr(0, length))) << length;
  }
}

TEST(NpyHeader, MessagesCarryNoControlCharacters) {
  const Error error = error_of("{'\x1b[31m\xff\n': 1}" + std::string(9, '\x07'));
  EXPECT_FALSE(error.message.empty());
  for (const char c : error.message) EXPECT_GE(c, ' ');
}

TEST(NpyPreamble, ReadsTheThreeVersions) {
  for (const int version : {1, 2, 3}) {
    NpyBytes bytes;
    bytes.version = version;
    const std::string file = bytes.file();
    const auto sut = parse_npy_preamble(bytes_of(file));
    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->preamble_bytes, version == 1 ? 10U : 12U);
    EXPECT_EQ(sut->preamble_bytes + sut->text_bytes + bytes.data.size(), file.size());
  }
}

TEST(NpyPreamble, NamesMagicVersionAndLength) {
  std::string file = NpyBytes{}.file();
  const auto message_of = [](const std::string& bytes) {
    const auto sut = parse_npy_preamble(bytes_of(bytes));
    return sut ? std::string() : sut.error().message;
  };
  for (const std::size_t length : {0U, 1U, 5U}) {
    EXPECT_TRUE(message_of(file.substr(0, length)).starts_with("magic"));
  }
  EXPECT_TRUE(message_of("PK\x03\x04zipped").starts_with("magic"));
  EXPECT_TRUE(message_of(file.substr(0, 7)).starts_with("version"));
  EXPECT_TRUE(message_of(file.substr(0, 9)).starts_with("header length"));
  file[6] = 4;
  EXPECT_EQ(message_of(file), "version: 4.0 is not 1.0, 2.0 or 3.0");
  file[6] = 2;
  file.replace(8, 4, "\xff\xff\xff\xff");
  EXPECT_EQ(message_of(file), "header length: 4294967295 bytes; the limit is 65535");
}

}  // namespace
}  // namespace thimble::world
