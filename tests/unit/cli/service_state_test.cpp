#include "cli/service_state.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>

#include "tests/support/temporary_folder.hpp"

namespace thimble::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(ServiceState, IsReadInWhateverOrderItIsTold) {
  const auto sut = parse_service_state(
      "Result=exit-code\nExecMainStatus=2\nLoadState=loaded\nActiveState=failed\n");
  ASSERT_TRUE(sut);
  EXPECT_EQ(*sut, (ServiceState{"failed", "exit-code", 2}));
}

TEST(ServiceState, IsNothingWhereNoServiceIsInstalled) {
  for (const std::string text :
       {"", "LoadState=not-found\nActiveState=inactive\n", "ActiveState=failed\n",
        "LoadState=loaded\n", "LoadState=loaded\nActiveState=\x1b[2J\n", "LoadState"}) {
    EXPECT_FALSE(parse_service_state(text)) << text;
  }
  EXPECT_FALSE(parse_service_state("LoadState=loaded\nActiveState=active\n" +
                                   std::string(kMaxServiceText, '\n')));
}

TEST(ServiceState, DecidesWhatIsAdvised) {
  EXPECT_EQ(advice_without_daemon({}), "start one with: thimbled --config FILE");
  EXPECT_THAT(advice_without_daemon(ServiceState{"failed", "watchdog", 0}),
              AllOf(HasSubstr("has failed (watchdog)"), HasSubstr("journalctl -u thimbled"),
                    HasSubstr("thimble doctor")));
  EXPECT_THAT(advice_without_daemon(ServiceState{"inactive", "success", 0}),
              HasSubstr("sudo systemctl start thimbled"));
  EXPECT_THAT(advice_without_daemon(ServiceState{"active", "success", 0}),
              HasSubstr("another socket"));
  EXPECT_THAT(advice_without_daemon(ServiceState{"activating", "success", 0}),
              HasSubstr("is activating: systemctl status thimbled"));
}

// A `systemctl` that is planted in $PATH.
class AskedServiceManager : public testing::Test {
 protected:
  AskedServiceManager() { ::setenv("PATH", (folder_.path().string() + ":" + path_).c_str(), 1); }
  ~AskedServiceManager() override { ::setenv("PATH", path_.c_str(), 1); }
  void plant(const std::string& script) const {
    const std::string file = folder_.write("systemctl", "#!/bin/sh\n" + script + "\n");
    ASSERT_EQ(::chmod(file.c_str(), 0700), 0);
  }
  const std::string path_{std::getenv("PATH")};
  const testing_support::TemporaryFolder folder_;
};

TEST_F(AskedServiceManager, IsBelieved) {
  plant(
      "test \"$1 $2\" = 'show thimbled.service' && echo LoadState=loaded && echo "
      "ActiveState=failed && echo Result=signal");
  EXPECT_EQ(read_service_state(), (ServiceState{"failed", "signal", 0}));
}

TEST_F(AskedServiceManager, ThatSaysNothingOrWithoutEndIsNoAnswer) {
  plant("echo no manager runs >&2; exit 1");
  EXPECT_FALSE(read_service_state());
  plant("exec yes LoadState=loaded");
  EXPECT_FALSE(read_service_state());
  ::setenv("PATH", "/nowhere", 1);
  EXPECT_FALSE(read_service_state());
}

}  // namespace
}  // namespace thimble::cli
