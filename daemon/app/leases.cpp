#include "daemon/app/leases.hpp"

namespace thimble::app {

std::string_view to_string(Leases::Holder holder) noexcept {
  switch (holder) {
    case Leases::Holder::Nobody:
      return "none";
    case Leases::Holder::Configuration:
      return "configuration";
    case Leases::Holder::Client:
      return "client";
  }
  return "none";
}

Leases::Leases(const std::vector<Arm>& arms) {
  for (const Arm& arm : arms) {
    entries_.push_back(
        {arm, arm.is_configured_active ? Holder::Configuration : Holder::Nobody, 0, 0});
  }
}

Result<std::size_t> Leases::find(std::string_view arm) const {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].arm.name == arm) return i;
  }
  return fail(Errc::NotFound, "there is no arm '" + std::string(arm) + "'");
}

bool Leases::is_held_for(std::size_t index, Client client) const {
  const Entry& entry = entries_.at(index);
  return entry.holder == Holder::Configuration ||
         (entry.holder == Holder::Client && entry.client == client);
}

Result<Leases::Grant> Leases::acquire(std::string_view arm, Client client) {
  const Result<std::size_t> index = find(arm);
  if (!index) return tl::unexpected(index.error());
  Entry& entry = entries_[*index];
  if (entry.arm.is_configured_active) {
    entry.holder = Holder::Configuration;
    return Grant{false};
  }
  if (entry.holder == Holder::Client && entry.client != client) {
    return fail(Errc::Busy, "arm '" + entry.arm.name + "' is held by another connection");
  }
  if (entry.holder != Holder::Client) entry.number = ++granted_;
  entry.holder = Holder::Client;
  entry.client = client;
  return Grant{true};
}

Result<void> Leases::release(std::string_view arm) {
  const Result<std::size_t> index = find(arm);
  if (!index) return tl::unexpected(index.error());
  end(entries_[*index]);
  return {};
}

std::vector<std::string> Leases::drop_client(Client client) {
  std::vector<std::string> lost;
  for (Entry& entry : entries_) {
    if (entry.holder != Holder::Client || entry.client != client) continue;
    end(entry);
    lost.push_back(entry.arm.name);
  }
  return lost;
}

void Leases::end(Entry& entry) noexcept {
  entry.holder = Holder::Nobody;
  entry.client = 0;
  entry.number = 0;
}

}  // namespace thimble::app
