#include "daemon/api/request_body.hpp"

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <random>
#include <set>
#include <string>

namespace thimble::api {
namespace {

std::string refusal_of(std::string_view body) {
  const auto sut = parse_body(body);
  if (sut) return "";
  EXPECT_EQ(sut.error().http_status, 400U);
  EXPECT_EQ(sut.error().code, "malformed");
  return sut.error().message;
}

TEST(ApiBody, NamesTheKeyThatIsSaidTwice) {
  EXPECT_EQ(refusal_of(R"({"cell": 1, "cell": 0})"),
            "the body says the key \"cell\" twice in one object");
  EXPECT_EQ(refusal_of(R"([1, {"a": {"min": 0, "x": [], "min": 0}}])"),
            "the body says the key \"min\" twice in one object");
  EXPECT_EQ(refusal_of(R"({"": 1, "": 1})"), "the body says the key \"\" twice in one object");
}

TEST(ApiBody, SeesOneKeyBehindTwoSpellings) {
  EXPECT_EQ(refusal_of(R"({"cell": 1, "\u0063ell": 0})"),
            "the body says the key \"cell\" twice in one object");
}

TEST(ApiBody, QuotesAKeySoThatATerminalIsSafe) {
  EXPECT_EQ(refusal_of(R"({"\n\u001b": 1, "\n\u001b": 0})"),
            "the body says the key \"\\n\\u001b\" twice in one object");
  const std::string key = "\"" + std::string(1000, 'k') + "\"";
  EXPECT_EQ(refusal_of("{" + key + ":1," + key + ":1}"),
            "the body says a long key twice in one object");
}

TEST(ApiBody, TakesTheSameKeyInObjectsOfTheirOwn) {
  EXPECT_EQ(refusal_of(R"({"a": {"a": [{"a": 1}, {"a": 2}]}, "b": {"a": 1}})"), "");
}

TEST(ApiBody, TellsOfABodyThatIsNoDocument) {
  for (const char* body : {"", "{", "{\"a\": 1} x", "{\"a\": 1, }", "nul", "\xff"}) {
    EXPECT_EQ(refusal_of(body), "the body is no JSON") << body;
  }
  EXPECT_EQ(refusal_of(std::string(10000, '[')), "the body is no JSON");
}

// Documents of chance, of whose objects it is known whether one has a key twice.
class RandomDocument {
 public:
  explicit RandomDocument(unsigned seed) : random_(seed) {}

  [[nodiscard]] std::string value(int depth) {
    const std::uint64_t kind = depth == 0 ? 2 : random_() % 3;
    if (kind == 2) return "\"{\\\"a\\\":1\"";  // a text that looks like an object
    const std::size_t count = random_() % 4;
    std::string out;
    std::set<std::uint64_t> keys;
    for (std::size_t i = 0; i < count; ++i) {
      if (i > 0) out += ", ";
      if (kind == 0) out += key(keys) + ": ";
      out += value(depth - 1);
    }
    return kind == 0 ? "{" + out + "}" : "[" + out + "]";
  }
  [[nodiscard]] bool has_repeated() const { return has_repeated_; }

 private:
  std::string key(std::set<std::uint64_t>& keys) {
    static constexpr const char* kSpellings[][2] = {{"\"a\"", "\"\\u0061\""},
                                                    {"\"/\"", "\"\\/\""},
                                                    {"\"\"", "\"\""},
                                                    {"\"aa\"", "\"a\\u0061\""}};
    const std::uint64_t which = random_() % 4;
    has_repeated_ = !keys.insert(which).second || has_repeated_;
    return kSpellings[which][random_() % 2];
  }

  std::mt19937 random_;
  bool has_repeated_{false};
};

TEST(ApiBody, RefusesExactlyWhatSaysAKeyTwice) {
  int refused = 0;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    RandomDocument document(seed);
    const std::string body = document.value(4);
    EXPECT_EQ(refusal_of(body).empty(), !document.has_repeated()) << body;
    refused += document.has_repeated() ? 1 : 0;
  }
  EXPECT_GT(refused, 200);
  EXPECT_LT(refused, 1800);
}

}  // namespace
}  // namespace thimble::api
