#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/result.hpp"

namespace thimble::doctor {

// What one look-up may take: a line of group(5) that names 100,000 members of ten letters has 1
// MiB, an /etc/passwd of 100,000 users 10 MiB. More is refused, never cut: half a list of accounts
// would tell that somebody is no member.
inline constexpr std::size_t kMaxAccountBytes = std::size_t{1} << 24;

// The users and groups of a machine.
//
// Thread: one. Not RT: a directory of accounts may be asked over the network.
// Errors: NotFound (a file that cannot be opened), System and TooLarge (beyond kMaxAccountBytes),
// each naming what could not
//         be looked up. That there is no such account is none.
class Accounts {
 public:
  Accounts() = default;
  Accounts(const Accounts&) = delete;
  Accounts& operator=(const Accounts&) = delete;
  virtual ~Accounts() = default;

  [[nodiscard]] virtual Result<std::optional<std::uint32_t>> group(
      const std::string& name) const = 0;
  // Empty: the number has no name.
  [[nodiscard]] virtual Result<std::string> user_name(std::uint32_t user) const = 0;
  // Those that a login of that user would have, the primary one, too; empty: no such user.
  [[nodiscard]] virtual Result<std::vector<std::uint32_t>> groups_of(
      const std::string& user) const = 0;
};

// Of this machine where `root` is "/", by all its sources of names (nsswitch.conf(5)); else of the
// files /etc/passwd and /etc/group below `root`.
[[nodiscard]] std::unique_ptr<Accounts> accounts_below(const std::filesystem::path& root);

}  // namespace thimble::doctor
