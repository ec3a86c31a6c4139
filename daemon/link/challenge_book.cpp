#include "daemon/link/challenge_book.hpp"

#include <algorithm>

#include "daemon/link/network_bytes.hpp"
#include "daemon/link/seal.hpp"

namespace thimble::link {
namespace {

std::int64_t term_of(MonotonicTime now) noexcept { return now.since_epoch / ChallengeBook::kTerm; }

}  // namespace

ChallengeBook::ChallengeBook(const RandomBytes& random) {
  random(secret_);
  used_.reserve(kMaxUsed);
}

Nonce ChallengeBook::number_of(const Endpoint& from, const Nonce& arm, std::int64_t term) const {
  std::array<std::byte, 16 + 2 + 4 + 1 + sizeof(Nonce) + 8> text{};
  ByteWriter writer(text);
  writer.block(std::as_bytes(std::span(from.address)));
  writer.values(from.port);
  writer.values(from.scope);
  writer.values(from.is_v6 ? std::uint8_t{1} : std::uint8_t{0});
  writer.block(arm);
  writer.values(static_cast<std::uint64_t>(term));
  return keyed_sum(LinkKey(secret_), text);
}

Nonce ChallengeBook::challenge(const Endpoint& from, const Nonce& arm, MonotonicTime now) const {
  return number_of(from, arm, term_of(now));
}

bool ChallengeBook::is_good(const Endpoint& from, const Nonce& arm, const Nonce& told,
                            MonotonicTime now) const {
  const std::int64_t term = term_of(now);
  const bool is_mine = told == number_of(from, arm, term) || told == number_of(from, arm, term - 1);
  if (!is_mine) return false;
  return std::none_of(used_.begin(), used_.end(),
                      [&](const Used& used) { return used.nonce == told; });
}

bool ChallengeBook::use(const Nonce& told, MonotonicTime now) {
  std::erase_if(used_, [&](const Used& used) { return used.ends <= now; });
  if (used_.size() == kMaxUsed) return false;
  used_.push_back({told, now + 2 * kTerm});
  return true;
}

}  // namespace thimble::link
