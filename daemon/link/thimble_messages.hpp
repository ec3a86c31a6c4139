#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "daemon/coupling/messages.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// What the Thimble datagrams say; their bytes are in docs/link-protocol.md. Plain values, SI, that
// cross queues by copying. Thread: any; a copy is one thread's. Errors: none here; the codec
// refuses what cannot be.

enum class ThimbleKind : std::uint8_t {
  Hello = 1,         // arm: who I am, and once challenged, that I can hear you
  Challenge = 2,     // world: say that again with this number
  Welcome = 3,       // world: a session is yours
  Refusal = 4,       // world: it is not, and why
  Sample = 16,       // arm: a hand
  Constraints = 17,  // world: what holds it
  Idle = 19,         // world: heard, and nothing to say now
};

struct ThimbleHeader {
  ThimbleKind kind{};
  bool is_sealed{false};
  std::uint64_t session{0};   // chosen by the world; 0 before there is one
  std::uint64_t sequence{0};  // from 1, +1 a datagram of one direction of a session; never again
  bool operator==(const ThimbleHeader&) const = default;
};

// First in every datagram: with what comes back they tell round trip and clocks. Negative times do
// not exist; 0: none.
struct ThimbleTiming {
  MonotonicTime sent_at{};    // sender's clock
  MonotonicTime echo{};       // receiver's clock: sent_at of the datagram that this one follows
  MonotonicTime echoed_at{};  // sender's clock: when that one arrived
  bool operator==(const ThimbleTiming&) const = default;
};

// Letters, digits, '-' as the names of a configuration; zeros behind.
struct ShortName {
  static constexpr std::size_t kSize = 32;
  std::array<char, kSize> letters{};
  bool operator==(const ShortName&) const = default;
  // Cut to its size.
  [[nodiscard]] static ShortName of(std::string_view text) noexcept;
  [[nodiscard]] std::string_view view() const noexcept;
};

using Nonce = std::array<std::byte, 32>;

// What one side can do beyond what every version can, a bit each: bits that a peer does not know
// mean nothing to it.
using Capabilities = std::uint64_t;
// Of an arm: it may be coupled to another arm, and knows what arms say. Of a world's end: it is
// one.
inline constexpr Capabilities kBetweenArms = 1U << 0U;
// Of an arm: each of its samples waits for the answer to the one before.
inline constexpr Capabilities kLockStep = 1U << 1U;
// Of a world's end: what is asked in the name of a hand (HandSample::actions) is heard and done.
inline constexpr Capabilities kHearsActions = 1U << 2U;

// What an arm says of its half, so that the world can make the other.
struct ThimbleHalf {
  ShortName scheme{};
  std::uint8_t force_at{0};    // of "spring-damper": 0 the world, 1 both ends
  std::uint8_t zone_names{0};  // of "buffer-zone": 0 occupied cells, 1 faces
  double buffer_m{0};          // likewise
  bool operator==(const ThimbleHalf&) const = default;
};

struct ThimbleHello {
  ThimbleTiming timing{};
  Nonce arm_nonce{};    // of this attempt
  Nonce world_nonce{};  // of the challenge it answers; zeros: not challenged yet
  ThimbleHalf half{};
  Capabilities capabilities{0};
  bool operator==(const ThimbleHello&) const = default;
};

struct ThimbleChallenge {
  ThimbleTiming timing{};
  Nonce arm_nonce{};  // of the hello
  Nonce world_nonce{};
  bool operator==(const ThimbleChallenge&) const = default;
};

struct ThimbleWelcome {
  ThimbleTiming timing{};
  Nonce arm_nonce{};
  Capabilities capabilities{0};
  ShortName world{};
  std::array<std::uint32_t, 3> cells{};  // zeros: it has none
  double cell_m{0};
  std::uint64_t epoch{0};  // WorldCoupling::cells_epoch() of the half that was made
  bool operator==(const ThimbleWelcome&) const = default;
};

enum class ThimbleRefusalReason : std::uint8_t {
  Busy = 1,    // as many hands as the world takes
  Scheme = 2,  // the world has no other half for it
  Arm = 3,     // there is an arm, whose scheme does not go with it; only to who is kBetweenArms
};

struct ThimbleRefusal {
  ThimbleTiming timing{};
  Nonce arm_nonce{};
  ThimbleRefusalReason reason{};
  ShortName scheme{};  // with Arm: that arm's
  bool operator==(const ThimbleRefusal&) const = default;
};

struct ThimbleSample {
  ThimbleTiming timing{};
  coupling::HandSample sample{};
};

struct ThimbleConstraints {
  ThimbleTiming timing{};
  std::uint64_t request{0};  // ThimbleHeader::sequence of the sample it answers
  coupling::ConstraintSet set{};
};

struct ThimbleIdle {
  ThimbleTiming timing{};
  std::uint64_t request{0};
  bool operator==(const ThimbleIdle&) const = default;
};

}  // namespace thimble::link
