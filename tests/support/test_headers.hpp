#pragma once

// What most tests include, read once for all of them (decision 0449). Whoever uses one of these
// includes it all the same: the preset dev compiles without this file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <tl/expected.hpp>
#include <tuple>
#include <variant>
#include <vector>
