#include "cli/names.hpp"

#include <gtest/gtest.h>

#include "daemon/config/name.hpp"

namespace thimble::cli {
namespace {

TEST(Name, IsRefusedWhereItIsNoArmsAndNoWorlds) {
  for (const char* name : {"right", "a", "box-3"}) EXPECT_EQ(refuse_no_name(name), "") << name;
  for (const std::string& name :
       {std::string(), std::string("A"), std::string("a b"), std::string("../x"),
        std::string(config::kMaxNameBytes + 1, 'a')}) {
    EXPECT_NE(refuse_no_name(name), "") << name;
  }
}

TEST(Name, IsRefusedInWordsWithoutControlBytes) {
  EXPECT_EQ(refuse_no_name("\x1b[31m"), "expected a name of 1 to " +
                                            std::to_string(config::kMaxNameBytes) +
                                            " of a-z, 0-9 and -, found \"?[31m\"");
}

}  // namespace
}  // namespace thimble::cli
