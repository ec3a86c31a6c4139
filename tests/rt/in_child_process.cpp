#include "tests/rt/in_child_process.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>

namespace thimble::test {
namespace {

constexpr uid_t kNobody = 65534;

bool drop_rights() {
  const rlimit none{0, 0};
  if (::setrlimit(RLIMIT_RTPRIO, &none) != 0) return false;
  if (::setrlimit(RLIMIT_MEMLOCK, &none) != 0) return false;
  // A root user also loses its capabilities with this; another one has none to lose.
  return ::geteuid() != 0 || ::setresuid(kNobody, kNobody, kNobody) == 0;
}

// Noexcept: an exception must not take the child up into the test runner.
[[noreturn]] void child(Rights rights, const std::function<std::string()>& function,
                        int out) noexcept {
  std::string answer = "rights not dropped";
  if (rights == Rights::AsTheTest || drop_rights()) answer = function();
  const ssize_t written = ::write(out, answer.data(), answer.size());
  ::_exit(written == static_cast<ssize_t>(answer.size()) ? 0 : 1);
}

}  // namespace

std::string in_child_process(Rights rights, const std::function<std::string()>& function) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) return "no pipe";
  const pid_t pid = ::fork();
  if (pid < 0) return "no fork";
  if (pid == 0) child(rights, function, ends[1]);
  ::close(ends[1]);

  std::string answer;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t got = ::read(ends[0], buffer.data(), buffer.size());
    if (got <= 0) break;
    answer.append(buffer.data(), static_cast<std::size_t>(got));
  }
  ::close(ends[0]);
  int status = 0;
  ::waitpid(pid, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? answer : "child died";
}

}  // namespace thimble::test
