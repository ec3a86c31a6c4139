#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>

#include "cli/doctor/daemon_socket.hpp"
#include "tests/unit/cli/doctor/doctor_fixture.hpp"

// Which process is taken for the daemon, and what is said of those that are not.
namespace thimble::doctor {
namespace {

class DoctorDaemon : public Doctor {
 protected:
  [[nodiscard]] Facts facts_with(const DaemonAtSocket& socket) const {
    Facts facts = read_facts(machine_.root(), plugins_.drivers, socket);
    facts.controllers.clear();
    facts.dma_latency.mode = 0666;
    return facts;
  }
  // A process without any right, called as the daemon.
  void plant_namesake(int pid) const {
    machine_.plant_process(pid, "thimbled", "/dev/null");
    machine_.plant_user(pid, 1000);
  }
};

TEST_F(DoctorDaemon, IsWhoListensAtTheSocketWhateverItIsCalled) {
  machine_.plant_process(300, "worker", "/dev/null");
  machine_.plant_user(300, 1000);
  const Facts facts = facts_with({300, ""});

  EXPECT_EQ(facts.process.pid, 300);
  EXPECT_EQ(facts.process.user_name, "mallory");
  const Verdict verdict = check_daemon(facts);
  EXPECT_EQ(verdict.level, Level::Ok);
  EXPECT_EQ(verdict.finding, "thimbled (process 300 of user 'mallory') listens at the socket");
}

TEST_F(DoctorDaemon, IsElseWhoRunsTheInstalledProgram) {
  machine_.plant("proc/77/comm", "anything\n");
  const Facts facts = facts_with({});

  EXPECT_EQ(facts.process.pid, 77);
  EXPECT_EQ(
      check_daemon(facts).finding,
      "thimbled (process 77 of user 'haptics') runs the thimbled that belongs to this thimble");
}

TEST_F(DoctorDaemon, IsKnownByTheProgramBesideTheOneThatAsks) {
  machine_.plant("opt/bin/thimbled", "");
  machine_.run_program(77, "opt/bin/thimbled");
  EXPECT_EQ(facts_with({}).process.pid, 0);
  std::filesystem::create_directories(machine_.root() / "proc/self");
  std::filesystem::create_symlink("/opt/bin/thimble", machine_.root() / "proc/self/exe");
  EXPECT_EQ(facts_with({}).process.pid, 77);
}

// The program is installed for everybody: a stranger who starts it is given nothing.
TEST_F(DoctorDaemon, OfAStrangerIsGivenNoRightForItsProgramAlone) {
  for (const unsigned user : {0U, 900U, 1000U, 1001U, 64000U}) {
    for (const char* cgroup :
         {"0::/user.slice/session-3.scope\n", "0::/user.slice/user@1001.service/x.service\n",
          "0::/system.slice/x.service\n"}) {
      machine_.plant("etc/passwd", "thimble:x:900:1::/:/\neve:x:1001:1::/:/\n");
      machine_.plant_user(77, user);
      machine_.plant("proc/77/cgroup", cgroup);
      machine_.plant_limits("0", "65536");
      const bool is_a_strangers = user == 1000 || user == 1001;
      Facts facts = facts_with({});
      EXPECT_EQ(facts.process.pid, 77);
      for (const bool has_group : {true, false}) {
        if (!has_group) facts.thimble_group.reset();
        const std::vector<Verdict> all = complaints(facts);
        ASSERT_THAT(all, SizeIs(3)) << user << " has neither group nor limits";
        for (const Verdict& verdict : all) {
          const bool gives = verdict.command.find("adduser") != std::string::npos ||
                             verdict.command.find(".d/") != std::string::npos ||
                             verdict.command.find("restart") != std::string::npos;
          EXPECT_EQ(gives, !is_a_strangers) << user << ": " << verdict.command;
          EXPECT_EQ(verdict.look_with.starts_with("ps "), is_a_strangers) << verdict.check;
          EXPECT_EQ(verdict.advice.starts_with("anybody may start"), is_a_strangers);
        }
      }
      EXPECT_FALSE(facts_with({77, ""}).process.is_a_strangers) << "the socket is its place";
    }
  }
}

TEST_F(DoctorDaemon, IsNobodyByNameAloneAndNoCommandGivesSuchARight) {
  machine_.remove("proc/77");
  plant_namesake(50);
  machine_.run_program(50, "usr/bin/steam");
  plant_namesake(60);
  machine_.plant("proc/self/status", "Uid:\t7\t7\t7\t7\nGid:\t7\t7\t7\t7\nCapEff:\t0\n");
  const Facts facts = facts_with({});

  EXPECT_EQ(facts.process.pid, 0);
  const std::vector<Verdict> all = complaints(facts);
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all[0].check, "daemon");
  EXPECT_EQ(all[0].level, Level::Warn);
  EXPECT_EQ(all[0].command, "");
  EXPECT_THAT(all[0].finding,
              AllOf(HasSubstr("process 50 of user 'mallory' calls itself 'thimbled'"),
                    HasSubstr("process 60 of user 'mallory'")));
  for (const Verdict& verdict : all) {
    EXPECT_THAT(verdict.command, Not(AnyOf(HasSubstr("mallory"), HasSubstr("1000"))));
  }
}

TEST_F(DoctorDaemon, IsStillLookedAtBesideOneThatIsOnlyCalledSo) {
  plant_namesake(50);
  const std::vector<Verdict> all = complaints(facts_with({77, ""}));
  expect_one(all, Level::Warn, "daemon", "process 77 of user 'haptics') listens at the socket; ");
  EXPECT_THAT(all[0].finding, HasSubstr("; process 50 of user 'mallory' calls itself"));
}

TEST_F(DoctorDaemon, MayHideItsRights) {
  const Facts facts = facts_with({4711, ""});
  EXPECT_EQ(facts.process.pid, 0);
  expect_one({check_daemon(facts)}, Level::Warn, "daemon",
             "the rights of thimbled (process 4711) are not shown");
}

TEST_F(DoctorDaemon, IsNotReachedForAReasonThatIsSaid) {
  expect_one(complaints(facts_with({std::nullopt, "you may not talk to it"})), Level::Warn,
             "daemon", "runs the thimbled that belongs to this thimble; you may not talk to it");
}

// A socket at which this very program listens.
class Listener {
 public:
  explicit Listener(const std::filesystem::path& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(socket_, 1), 0);
  }
  ~Listener() { ::close(socket_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

 private:
  int socket_{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
};

TEST(DaemonSocket, IsAskedWhoListens) {
  testing_support::TemporaryFolder folder;
  const std::filesystem::path path = folder / "thimble.sock";
  EXPECT_EQ(who_listens("/", path.string()), DaemonAtSocket{}) << "nobody";
  const Listener listener(path);
  EXPECT_EQ(who_listens("/", path.string()), (DaemonAtSocket{::getpid(), ""}));
  EXPECT_EQ(who_listens(folder.path(), path.string()), DaemonAtSocket{})
      << "of another machine no socket of this one tells";
}

TEST(DaemonSocket, IsNotBelievedInAPlaceThatAnybodyCouldTake) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a folder to somebody else";
  testing_support::TemporaryFolder folder;
  const std::filesystem::path place = folder / "thimble-0";
  std::filesystem::create_directory(place);
  const Listener listener(place / "thimble.sock");
  ASSERT_EQ(::chown(place.c_str(), 1000, 1000), 0);
  EXPECT_EQ(who_listens("/", place / "thimble.sock").pid, ::getpid()) << "root let them have it";
  ASSERT_EQ(::chmod(folder.path().c_str(), 01777), 0);
  const DaemonAtSocket found = who_listens("/", place / "thimble.sock");
  EXPECT_EQ(found.pid, std::nullopt);
  EXPECT_THAT(found.trouble, HasSubstr("belongs to another user"));
}

TEST(DaemonSocket, IsNotBelievedInAFolderOfRootThatAnybodyMayWrite) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a socket to somebody else";
  testing_support::TemporaryFolder folder;
  const std::filesystem::path path = folder / "thimble.sock";
  const Listener listener(path);
  ASSERT_EQ(::chmod(folder.path().c_str(), 01777), 0);
  EXPECT_EQ(who_listens("/", path).pid, ::getpid()) << "root's own socket";
  ASSERT_EQ(::chown(path.c_str(), 1000, 1000), 0);
  const DaemonAtSocket found = who_listens("/", path);
  EXPECT_EQ(found.pid, std::nullopt);
  EXPECT_THAT(found.trouble, HasSubstr("belongs to another user"));
}

}  // namespace
}  // namespace thimble::doctor
