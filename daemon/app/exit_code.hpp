#pragma once

namespace thimble::app {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailure = 1;  // something that this machine or its devices refused
inline constexpr int kExitUsage = 2;    // the command line or the configuration is wrong

}  // namespace thimble::app
