#include "drivers/cambus/video_timing.hpp"

#include <algorithm>

namespace thimble::cambus {
namespace {

constexpr std::uint32_t kMHz = 1'000'000;
constexpr std::uint32_t kScanLines = 512;
constexpr std::uint32_t kBlankLines = 13;
constexpr std::array<std::pair<std::uint32_t, VideoTiming>, 3> kKnown{{
    {20 * kMHz, {548, 88, kScanLines, kBlankLines}},
    {21 * kMHz, {547, 129, kScanLines, kBlankLines}},
    {25 * kMHz, {547, 247, kScanLines, kBlankLines}},
}};
// Of the fastest of them; what other clocks have is derived.
constexpr VideoTiming kModel = kKnown.back().second;
constexpr std::uint32_t kModel_hz = kKnown.back().first;
// Of 512 sites with their refreshes; and from there to the next run, where another module is on
// video: show-scan of both, the select between them, the run (docs/cambus.md, section 5).
constexpr std::uint32_t kSweep_clocks = 512 + 40 + 2 * 4;
constexpr std::uint32_t kHandOver_clocks = 16 + 14 + 16 + 18;
constexpr std::uint32_t kShortestLine_clocks = kSweep_clocks + kHandOver_clocks;

}  // namespace

std::optional<VideoTiming> video_timing(std::uint32_t clock_hz) noexcept {
  const auto known = std::find_if(kKnown.begin(), kKnown.end(),
                                  [&](const auto& of) { return of.first == clock_hz; });
  if (known != kKnown.end()) return known->second;
  const std::uint64_t line = std::uint64_t{clock_hz} * kModel.line_clocks() / kModel_hz;
  if (line < kShortestLine_clocks || line > page::kLengthMask) return std::nullopt;
  const auto clocks = static_cast<std::uint32_t>(line);
  return VideoTiming{kModel.scan_clocks, clocks - kModel.scan_clocks, kScanLines, kBlankLines};
}

}  // namespace thimble::cambus
