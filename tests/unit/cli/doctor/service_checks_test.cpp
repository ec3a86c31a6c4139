#include "cli/doctor/read_configuration.hpp"
#include "tests/unit/cli/doctor/doctor_fixture.hpp"

// What starts the daemon, and the configuration that it is started with.
namespace thimble::doctor {
namespace {

class DoctorOfTheService : public Doctor {
 protected:
  [[nodiscard]] ReadConfiguration read(const std::string& file = {}) const {
    session::Plugins plugins;
    return read_configuration(FileTree(machine_.root()), machine_.root(), file, plugins);
  }
  [[nodiscard]] std::vector<Verdict> complaints_with(const ConfigurationFile& configuration) const {
    Facts all = facts();
    all.configuration = configuration;
    return complaints(all);
  }
  [[nodiscard]] std::vector<Verdict> complaints_with(const cli::ServiceState& service) const {
    Facts all = facts();
    all.service = service;
    return complaints(all);
  }
};

TEST_F(DoctorOfTheService, HasNothingAgainstOneThatRuns) {
  EXPECT_THAT(complaints_with(cli::ServiceState{"active", "success", 0}), SizeIs(0));
}

TEST_F(DoctorOfTheService, TellsOfOneThatFailedAndWhereItsReasonIs) {
  const auto crashed = complaints_with(cli::ServiceState{"failed", "watchdog", 0});
  expect_complaint(crashed, Level::Wrong, "service", "thimbled.service has failed (watchdog)",
                   "sudo systemctl restart thimbled");
  EXPECT_THAT(crashed.at(0).look_with, HasSubstr("journalctl -u thimbled"));
  expect_complaint(complaints_with(cli::ServiceState{"failed", "exit-code", 2}), Level::Wrong,
                   "service", "its configuration is wrong", "sudo systemctl restart thimbled");
}

TEST_F(DoctorOfTheService, TellsOfOneThatDoesNotRun) {
  expect_complaint(complaints_with(cli::ServiceState{"inactive", "success", 0}), Level::Warn,
                   "service", "is inactive", "sudo systemctl start thimbled");
  EXPECT_THAT(complaints_with(cli::ServiceState{"activating", "exit-code", 0}),
              testing::ElementsAre(AllOf(Field(&Verdict::level, Level::Warn),
                                         Field(&Verdict::look_with, HasSubstr("journalctl")))));
}

TEST_F(DoctorOfTheService, LooksAtItsConfigurationUnaskedAndAtNoneThatIsNotThere) {
  EXPECT_EQ(read().about, ConfigurationFile{});
  machine_.plant("etc/thimble/thimble.toml",
                 "[servo]\nrate_hz = 2000\n[[world]]\nname = 'x'\nsource = 'box:3'\n");
  const ReadConfiguration good = read();
  EXPECT_THAT(good.about.mistakes, SizeIs(0));
  EXPECT_EQ(good.config.servo.rate_hz, 2000);
  EXPECT_THAT(complaints_with(good.about), SizeIs(0));
}

TEST_F(DoctorOfTheService, SaysWhatACheckOfTheConfigurationSays) {
  machine_.plant("etc/thimble/thimble.toml",
                 "[[arm]]\nname = 'right'\ndevice = 'usb:1-4'\nfirmware = 'none.bin'\n"
                 "world = 'x'\n[[world]]\nname = 'x'\nsource = 'none.npy'\n");
  const ReadConfiguration bad = read();
  const auto all = complaints_with(bad.about);
  ASSERT_THAT(all, SizeIs(1));
  EXPECT_EQ(all[0].level, Level::Wrong);
  EXPECT_EQ(all[0].check, "configuration");
  EXPECT_THAT(all[0].finding, AllOf(HasSubstr("thimble.toml:4:"), HasSubstr("there is no firmware"),
                                    HasSubstr("; "), HasSubstr("none.npy")));
  EXPECT_THAT(all[0].look_with, HasSubstr("thimbled --check --config "));
}

TEST_F(DoctorOfTheService, RepeatsWhatTheDaemonDoubtsOfAGoodConfiguration) {
  const std::string falcon =
      "[[arm]]\nname = 'right'\ndevice = 'usb:1-4'\nmodel = 'falcon'\nworld = 'x'\n"
      "[[world]]\nname = 'x'\nsource = 'box:3'\n";
  machine_.plant("etc/thimble/thimble.toml", falcon);
  const auto all = complaints_with(read().about);
  ASSERT_THAT(all, SizeIs(2));
  for (const Verdict& verdict : all) {
    EXPECT_EQ(verdict.level, Level::Warn);
    EXPECT_EQ(verdict.check, "configuration");
  }
  EXPECT_THAT(all[0].finding, HasSubstr("arm 'right' lacks arm.firmware"));
  EXPECT_THAT(all[1].finding, HasSubstr("arm 'right' may go on pushing"));
  machine_.plant("etc/thimble/thimble.toml", falcon + "[[arm]]\nname = 3\n");
  EXPECT_THAT(read().about.doubts, SizeIs(0)) << "its mistakes come first";
}

TEST_F(DoctorOfTheService, NamesAConfigurationThatTheServiceMayNotRead) {
  machine_.plant("etc/thimble/thimble.toml", "");
  machine_.plant("etc/passwd", "thimble:x:990:991::/:/usr/sbin/nologin\n");
  EXPECT_TRUE(read().about.may_service_read);
  machine_.chmod("etc/thimble/thimble.toml", 0600);
  const ReadConfiguration kept = read();
  EXPECT_FALSE(kept.about.may_service_read);
  expect_complaint(complaints_with(kept.about), Level::Wrong, "configuration",
                   "cannot be read by the service", "sudo chmod 640 ");
  machine_.remove("etc/passwd");
  EXPECT_TRUE(read().about.may_service_read) << "there is no such account";
}

TEST_F(DoctorOfTheService, SaysWhereWhoAsksMayNotLook) {
  ConfigurationFile hidden;
  hidden.file = "/etc/thimble/thimble.toml";
  hidden.is_hidden = true;
  const auto all = complaints_with(hidden);
  ASSERT_THAT(all, SizeIs(1));
  EXPECT_EQ(all[0].level, Level::Warn);
  EXPECT_THAT(all[0].look_with, HasSubstr("sudo thimble doctor"));
}

}  // namespace
}  // namespace thimble::doctor
