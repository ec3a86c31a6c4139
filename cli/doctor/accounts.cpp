#include "cli/doctor/accounts.hpp"

#include <grp.h>
#include <pwd.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstring>
#include <utility>

#include "cli/doctor/file_tree.hpp"
#include "cli/doctor/proc_text.hpp"
#include "cli/file_text.hpp"

namespace thimble::doctor {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFirstBuffer = std::size_t{1} << 14;

std::string too_large() {
  return "more than " + std::to_string(kMaxAccountBytes >> 20U) + " MiB, which is not read";
}

// Of a machine whose files alone are here.
class FileAccounts final : public Accounts {
 public:
  explicit FileAccounts(const fs::path& root)
      : groups_(whole(root, "etc/group")), users_(whole(root, "etc/passwd")) {}

  [[nodiscard]] Result<std::optional<std::uint32_t>> group(const std::string& name) const override {
    if (!groups_) return tl::unexpected<Error>(groups_.error());
    return parse_group(*groups_, name);
  }
  [[nodiscard]] Result<std::string> user_name(std::uint32_t user) const override {
    if (!users_) return tl::unexpected<Error>(users_.error());
    return parse_user(*users_, user);
  }
  [[nodiscard]] Result<std::vector<std::uint32_t>> groups_of(
      const std::string& user) const override {
    if (!groups_) return tl::unexpected<Error>(groups_.error());
    if (!users_) return tl::unexpected<Error>(users_.error());
    const auto primary = parse_primary_group(*users_, user);
    if (!primary) return std::vector<std::uint32_t>{};
    std::vector<std::uint32_t> groups = parse_memberships(*groups_, user);
    groups.push_back(*primary);
    return groups;
  }

 private:
  // A file that is not there holds nobody.
  static Result<std::string> whole(const fs::path& root, const char* file) {
    const fs::path path = root / file;
    std::error_code error;
    if (fs::status(path, error).type() == fs::file_type::not_found) return std::string();
    auto text = cli::read_at_most(path.string(), kMaxAccountBytes + 1);
    if (!text) return tl::unexpected<Error>(text.error().in(std::string("/") + file));
    if (text->size() <= kMaxAccountBytes) return text;
    return fail(Errc::TooLarge, std::string("/") + file + " has " + too_large());
  }

  Result<std::string> groups_;
  Result<std::string> users_;
};

// What getpwnam(3) and its like say where there is no such account; some sources of names use the
// others of this list.
bool is_no_such_account(int error) {
  return error == 0 || error == ENOENT || error == ESRCH || error == EBADF || error == EPERM;
}

// `ask` is one of the …_r functions: it gets the entry, a buffer and where to say what it found.
// Null is no such account; what is found points into `buffer`.
template <class Entry, class Ask>
Result<const Entry*> look_up(const std::string& what, Entry& entry, std::string& buffer, Ask ask) {
  for (buffer.resize(kFirstBuffer);; buffer.resize(buffer.size() * 2)) {
    Entry* found = nullptr;
    const int error = ask(&entry, buffer.data(), buffer.size(), &found);
    if (found != nullptr) return found;
    if (error == EINTR) continue;
    if (error != ERANGE) {
      if (is_no_such_account(error)) return static_cast<const Entry*>(nullptr);
      return fail(Errc::System, what + ": " + std::strerror(error));
    }
    if (buffer.size() >= kMaxAccountBytes)
      return fail(Errc::TooLarge, what + " has " + too_large());
  }
}

// Of this machine.
class SystemAccounts final : public Accounts {
 public:
  [[nodiscard]] Result<std::optional<std::uint32_t>> group(const std::string& name) const override {
    ::group entry{};
    std::string buffer;
    const auto found = look_up("group '" + name + "'", entry, buffer,
                               [&](auto* to, char* bytes, auto size, auto* out) {
                                 return ::getgrnam_r(name.c_str(), to, bytes, size, out);
                               });
    if (!found) return tl::unexpected<Error>(found.error());
    if (*found == nullptr) return std::optional<std::uint32_t>();
    return std::optional<std::uint32_t>((*found)->gr_gid);
  }
  [[nodiscard]] Result<std::string> user_name(std::uint32_t user) const override {
    ::passwd entry{};
    std::string buffer;
    const auto found = look_up("user " + std::to_string(user), entry, buffer,
                               [&](auto* to, char* bytes, auto size, auto* out) {
                                 return ::getpwuid_r(user, to, bytes, size, out);
                               });
    if (!found) return tl::unexpected<Error>(found.error());
    return *found == nullptr ? std::string() : std::string((*found)->pw_name);
  }
  [[nodiscard]] Result<std::vector<std::uint32_t>> groups_of(
      const std::string& user) const override {
    ::passwd entry{};
    std::string buffer;
    const auto found = look_up("user '" + user + "'", entry, buffer,
                               [&](auto* to, char* bytes, auto size, auto* out) {
                                 return ::getpwnam_r(user.c_str(), to, bytes, size, out);
                               });
    if (!found) return tl::unexpected<Error>(found.error());
    if (*found == nullptr) return std::vector<std::uint32_t>{};
    return memberships(user, (*found)->pw_gid);
  }

 private:
  static Result<std::vector<std::uint32_t>> memberships(const std::string& user, gid_t primary) {
    for (int room = 64; room <= 2 * NGROUPS_MAX; room *= 2) {
      std::vector<gid_t> groups(static_cast<std::size_t>(room));
      int count = room;
      if (::getgrouplist(user.c_str(), primary, groups.data(), &count) < 0) continue;
      return std::vector<std::uint32_t>(groups.begin(), groups.begin() + count);
    }
    return fail(Errc::TooLarge,
                "user '" + user + "' is in more groups than the kernel has room for");
  }
};

}  // namespace

std::unique_ptr<Accounts> accounts_below(const fs::path& root) {
  if (is_this_machine(root)) return std::make_unique<SystemAccounts>();
  return std::make_unique<FileAccounts>(root);
}

}  // namespace thimble::doctor
