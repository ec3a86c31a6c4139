#pragma once

#include <cstdint>

namespace thimble::link {

// Sorts numbered messages, each number sent once, into newest, seen before and overtaken.
//
// Thread: one. RT: allocation-free. Errors: none. Numbers start at 1 and never wrap.
class SequenceWindow {
 public:
  enum class Verdict : std::uint8_t {
    Newest,
    Duplicate,
    Overtaken,  // or too old to tell
  };

  // `skipped`: numbers between the last newest and this one, not seen yet.
  struct Outcome {
    Verdict verdict{};
    std::uint64_t skipped{0};
  };

  Outcome note(std::uint64_t sequence) noexcept {
    if (sequence > newest_) {
      const std::uint64_t step = sequence - newest_;
      seen_ = step < kWidth ? (seen_ << step) | 1U : 1U;
      newest_ = sequence;
      return {Verdict::Newest, step - 1};
    }
    const std::uint64_t age = newest_ - sequence;
    if (age >= kWidth) return {Verdict::Overtaken, 0};
    const std::uint64_t bit = std::uint64_t{1} << age;
    if ((seen_ & bit) != 0) return {Verdict::Duplicate, 0};
    seen_ |= bit;
    return {Verdict::Overtaken, 0};
  }

 private:
  static constexpr std::uint64_t kWidth = 64;
  std::uint64_t newest_{0};
  std::uint64_t seen_{1};  // bit i: newest_ - i was seen; 0 stands for "nothing yet"
};

}  // namespace thimble::link
