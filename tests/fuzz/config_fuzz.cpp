#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/config/load.hpp"
#include "hal/base/check.hpp"

// Configuration text, then after a zero byte one override per line.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::size_t zero = input.find('\0');
  std::vector<std::string> overrides;
  std::string_view rest = zero == std::string_view::npos ? "" : input.substr(zero + 1);
  while (!rest.empty() && overrides.size() < 8) {
    const std::size_t end = rest.find('\n');
    overrides.emplace_back(rest.substr(0, end));
    rest = end == std::string_view::npos ? "" : rest.substr(end + 1);
  }
  const auto result = thimble::config::parse(input.substr(0, zero), "fuzz.toml", overrides);
  if (result) {
    THIMBLE_CHECK(!result->arms.empty() || !result->worlds.empty());
    const double rate_hz = result->servo.rate_hz.value_or(1000);
    THIMBLE_CHECK(rate_hz >= 500 && rate_hz <= 8000);
    return 0;
  }
  THIMBLE_CHECK(!result.error().empty());
  for (const auto& error : result.error()) {
    THIMBLE_CHECK(!error.message.empty());
    // A message is one line and carries no control bytes of the input to a terminal.
    for (const char c : error.key + error.message) {
      THIMBLE_CHECK(static_cast<unsigned char>(c) >= 0x20);
    }
  }
  return 0;
}
