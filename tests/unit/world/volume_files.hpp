#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/support/temporary_folder.hpp"

namespace thimble::world {

// Volume files in a folder that goes with the test.
class VolumeFiles : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) const {
    return home_.write(name, bytes).string();
  }

 private:
  testing_support::TemporaryFolder home_;

 protected:
  const std::string folder = home_.path().string();
};

}  // namespace thimble::world
