#pragma once

// Seconds to start the smallest program there is and see it end; negative when it cannot be.
[[nodiscard]] double reference_spawn_s();
