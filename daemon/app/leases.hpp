#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"

namespace thimble::app {

// Who may keep an arm active: the configuration (activate = true), or the connection that
// asked for it over the API, until that connection closes. Pure bookkeeping.
//
// Thread: the net plane's one thread.
class Leases {
 public:
  using Client = std::uint64_t;

  enum class Holder : std::uint8_t { Nobody, Configuration, Client };
  struct Grant {
    bool is_bound_to_connection{false};  // false: the configuration's lease was taken up again
  };

  // `arms`: whether each arm's configuration holds a lease of its own.
  struct Arm {
    std::string name;
    bool is_configured_active{false};
  };
  explicit Leases(const std::vector<Arm>& arms);

  // NotFound: no such arm. Busy: another connection holds it.
  [[nodiscard]] Result<Grant> acquire(std::string_view arm, Client client);
  // Anyone may end a lease: stopping is always allowed.
  [[nodiscard]] Result<void> release(std::string_view arm);
  // The arms that lost their lease because `client` is gone.
  [[nodiscard]] std::vector<std::string> drop_client(Client client);
  // Index order of the constructor.
  [[nodiscard]] Holder holder(std::size_t index) const { return entries_.at(index).holder; }
  // Of a client's lease: no later one has it while the daemon runs. 0: no client holds the arm.
  [[nodiscard]] std::uint64_t number(std::size_t index) const { return entries_.at(index).number; }
  // By the configuration or by this very client.
  [[nodiscard]] bool is_held_for(std::size_t index, Client client) const;
  // NotFound: no such arm.
  [[nodiscard]] Result<std::size_t> find(std::string_view arm) const;

 private:
  struct Entry {
    Arm arm;
    Holder holder{Holder::Nobody};
    Client client{0};
    std::uint64_t number{0};
  };
  static void end(Entry& entry) noexcept;

  std::uint64_t granted_{0};  // leases of clients
  std::vector<Entry> entries_;
};

[[nodiscard]] std::string_view to_string(Leases::Holder holder) noexcept;

}  // namespace thimble::app
