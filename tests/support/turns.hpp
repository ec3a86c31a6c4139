#pragma once

namespace thimble::test {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kIsSlow = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool kIsSlow = true;
#else
inline constexpr bool kIsSlow = false;
#endif
#else
inline constexpr bool kIsSlow = false;
#endif

// How many of `whole` random cases a test plays: all, and a fifth under AddressSanitizer, which
// takes ten times as long for each and looks at how, not at what is reckoned. Pure.
constexpr int turns(int whole) noexcept { return kIsSlow ? whole / 5 : whole; }

}  // namespace thimble::test
