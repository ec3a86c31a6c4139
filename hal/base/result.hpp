#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace thimble {

enum class Errc {
  InvalidArgument,  // a value that the caller chose cannot be
  NotFound,         // the named thing does not exist
  NotMine,          // a probe says: ask the next driver
  Permission,       // a missing right; the message names it
  Busy,             // somebody else holds it
  Disconnected,     // the device or peer is gone
  Timeout,
  Malformed,  // bytes from outside that do not parse
  TooLarge,   // bytes from outside that exceed a stated limit
  Unsupported,
  System,  // the operating system refused; the message carries its word
};

std::string_view to_string(Errc code) noexcept;

// Why an operation off the servo plane failed, in words for a person.
// Callers add context in front while it travels up, as a path: "arm 'left': open: …".
struct Error {
  Errc code{};
  std::string message;

  [[nodiscard]] Error in(std::string_view context) const {
    return {code, std::string(context) + ": " + message};
  }
  bool operator==(const Error&) const = default;
};

// Outputs are untouched on failure. Not for the servo plane: per-tick calls return IoStatus.
template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(Errc code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace thimble
