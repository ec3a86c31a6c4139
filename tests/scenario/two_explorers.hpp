#pragma once

namespace thimble::test {

// Two arms that explore the box of the thesis, each by a hand of its own.
inline constexpr const char* kTwoExplorers = R"(
[[arm]]
name = "right"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
world = "box"
[arm.hand]
motion = "explore"
seed = 1
[[arm]]
name = "left"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
world = "box"
[arm.hand]
motion = "explore"
seed = 2
[[world]]
name = "box"
source = "box:3"
)";

}  // namespace thimble::test
