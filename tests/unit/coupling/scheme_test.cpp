#include "daemon/coupling/scheme.hpp"

#include <gtest/gtest.h>

#include "daemon/coupling/thesis_literal.hpp"

namespace thimble::coupling {
namespace {

TEST(Scheme, NamesAreReadAsTheyAreWritten) {
  for (const Scheme scheme : {Scheme::GhostPoint, Scheme::ThesisLiteral}) {
    const Result<Scheme> parsed = parse_scheme(to_string(scheme));
    ASSERT_TRUE(parsed);
    EXPECT_EQ(*parsed, scheme);
  }
}

TEST(Scheme, UnknownNameIsRefusedWithWhatWasExpected) {
  for (const char* text : {"", "ghost", "Ghost-Point", "ghost-point "}) {
    const Result<Scheme> parsed = parse_scheme(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().code, Errc::InvalidArgument);
    EXPECT_NE(parsed.error().message.find("ghost-point or thesis-literal"), std::string::npos);
  }
}

TEST(Scheme, MakesTheArmHalfItNames) {
  const auto ghost = make_arm_coupling(Scheme::GhostPoint, {});
  const auto literal = make_arm_coupling(Scheme::ThesisLiteral, {});
  EXPECT_NE(dynamic_cast<GhostPointArm*>(ghost.get()), nullptr);
  EXPECT_NE(dynamic_cast<ThesisLiteralArm*>(literal.get()), nullptr);
}

}  // namespace
}  // namespace thimble::coupling
