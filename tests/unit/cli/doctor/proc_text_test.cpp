#include "cli/doctor/proc_text.hpp"

#include <gtest/gtest.h>

namespace thimble::doctor {
namespace {

TEST(ProcText, TakesLimitsBySoftAndHardColumn) {
  const std::string text = "Max locked memory         65536       unlimited   bytes\n";
  const auto row = parse_limit(text, "Max locked memory");

  ASSERT_TRUE(row);
  EXPECT_EQ(row->soft, (Limit{false, 65536}));
  EXPECT_EQ(row->hard, (Limit{true, 0}));
  EXPECT_FALSE(parse_limit(text, "Max realtime priority"));
  EXPECT_FALSE(parse_limit("Max locked memory 1", "Max locked memory"));
  EXPECT_FALSE(parse_limit("Max locked memory -1 5", "Max locked memory"));
  EXPECT_FALSE(parse_limit("Max locked memory 99999999999999999999 5", "Max locked memory"));
}

TEST(ProcText, TakesTheEffectiveUserAndAllGroups) {
  Process process;
  parse_status("Uid:\t1\t2\t3\t4\nGid:\t5\t6\t7\t8\nGroups:\t9 x 10 \nCapEff:\t00000000a80425fb\n",
               process);

  EXPECT_EQ(process.user, 2U);
  EXPECT_EQ(process.groups, (std::vector<std::uint32_t>{9, 10, 6}));
  EXPECT_EQ(process.capabilities, 0xa80425fbU);
}

TEST(ProcText, FindsAGroupByItsWholeName) {
  const std::string file = "thimbles:x:1:\nthimble:x:42:a,b\nodd\nthimble2:x:3:";
  EXPECT_EQ(parse_group(file, "thimble"), 42U);
  EXPECT_EQ(parse_group(file, "thimble2"), 3U);
  EXPECT_FALSE(parse_group(file, "odd"));
  EXPECT_FALSE(parse_group(file, "thimble:x"));
  EXPECT_FALSE(parse_group("thimble:x", "thimble"));
  EXPECT_FALSE(parse_group("thimble:x:ten:", "thimble"));
}

TEST(ProcText, FindsTheGroupsThatListAUser) {
  const std::string file = "a:x:1:an\nb:x:2:ann,an\nc:x:3:ann\nd:x:x:an\nan:x:4:\ne:x:5:,an,\n";
  EXPECT_EQ(parse_memberships(file, "an"), (std::vector<std::uint32_t>{1, 2, 5}));
  EXPECT_EQ(parse_memberships(file, "nobody"), std::vector<std::uint32_t>{});
}

TEST(ProcText, FindsAUserByNumberAndItsGroupByName) {
  const std::string file =
      "root:x:0:8::/:\nodd\n:x:7:7::/:\nan:x:7:9::/:\nother:x:77:7::/:\nno:x:1\n";
  EXPECT_EQ(parse_user(file, 0), "root");
  EXPECT_EQ(parse_user(file, 7), "an");
  EXPECT_EQ(parse_user(file, 77), "other");
  EXPECT_EQ(parse_user(file, 1), "");
  EXPECT_EQ(parse_primary_group(file, "an"), 9U);
  EXPECT_EQ(parse_primary_group(file, "no"), std::nullopt);
  EXPECT_EQ(parse_primary_group(file, "odd"), std::nullopt);
}

TEST(ProcText, FindsTheServiceThatAProcessRunsIn) {
  EXPECT_EQ(parse_service("0::/system.slice/thimbled.service\n"), "thimbled.service");
  EXPECT_EQ(parse_service("0::/system.slice/system-a.slice/a@b.service/worker\n"), "a@b.service");
  EXPECT_EQ(parse_service("4:memory:/x.service\n1:name=systemd:/system.slice/y.service\n0::/\n"),
            "y.service");
  const std::string user = "0::/user.slice/user-5.slice/user@5.service/app.slice/";
  EXPECT_EQ(parse_service(user + "thimbled.service\n"), "user@5.service");
  EXPECT_EQ(parse_service(user + "app-terminal.scope\n"), "");
  for (const char* none : {"", "0::/", "0::/.service", "0::/user.slice/session-3.scope",
                           "0::/a.service/b.scope", "::", "a.service", "7:cpu:/a.service"}) {
    EXPECT_EQ(parse_service(none), "") << none;
  }
}

TEST(ProcText, TakesNumbersOfDescriptors) {
  EXPECT_EQ(parse_hexadecimal("cb48\n"), 0xcb48);
  EXPECT_EQ(parse_hexadecimal("02"), 2);
  for (const char* odd : {"", "-1", "0x1", "10000", "1 2", "g"}) {
    EXPECT_FALSE(parse_hexadecimal(odd)) << odd;
  }
}

TEST(ProcText, TakesHidIdsThatAreIds) {
  const auto ids = parse_hid_ids("HID_ID=0003:000016C0:00000486\nHID_UNIQ=12 34\n");
  ASSERT_TRUE(ids);
  EXPECT_EQ(ids->bus, 3);
  EXPECT_EQ(ids->vendor, 0x16c0);
  EXPECT_EQ(ids->product, 0x0486);
  EXPECT_EQ(ids->serial_number, "12 34");
  for (const char* odd :
       {"", "HID_ID=", "HID_ID=0003:1", "HID_ID=:1:1", "HID_ID=10000:1:1", "HID_ID=3:12345678:1",
        "HID_ID=3::1", "HID_ID=3:1:-1", "HID_NAME=0003:1:1"}) {
    EXPECT_FALSE(parse_hid_ids(odd)) << odd;
  }
}

}  // namespace
}  // namespace thimble::doctor
