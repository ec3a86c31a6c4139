#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "daemon/link/endpoint.hpp"
#include "daemon/link/seal.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// Numbers that a world gives to who wants a session, to be told back: only who hears at the address
// it writes from can, and each once. Nothing is kept of a challenge, so a flood of hellos fills
// nothing: the number is BLAKE2b, keyed by a secret of this process, of the address, the arm's
// nonce and the kTerm in which it was given. What is kept is which of them were used.
//
// Thread: one. RT: not; allocates when made. Errors: none.
class ChallengeBook {
 public:
  // Ours: longer than an arm holds on to one (ThimbleArmEnd::kAttempt).
  static constexpr Duration kTerm = std::chrono::seconds(8);
  // Ours: sessions that may begin within two terms; each needed the key, where there is one.
  static constexpr std::size_t kMaxUsed = 256;

  explicit ChallengeBook(const RandomBytes& random);

  [[nodiscard]] Nonce challenge(const Endpoint& from, const Nonce& arm, MonotonicTime now) const;
  // Whether that was told to `from` for `arm` in this term or the last, and is not used yet.
  [[nodiscard]] bool is_good(const Endpoint& from, const Nonce& arm, const Nonce& told,
                             MonotonicTime now) const;
  // False when too many were used lately: it is not taken.
  [[nodiscard]] bool use(const Nonce& told, MonotonicTime now);

 private:
  struct Used {
    Nonce nonce{};
    MonotonicTime ends{};
  };
  [[nodiscard]] Nonce number_of(const Endpoint& from, const Nonce& arm, std::int64_t term) const;

  std::array<std::byte, 32> secret_{};
  std::vector<Used> used_;
};

}  // namespace thimble::link
