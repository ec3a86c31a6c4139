#pragma once

#include <string>

namespace thimble::test {

// While one lives and until it is released, a thread of this program that opens `path` waits in
// open(), as behind a driver of the kernel that hangs. For programs that list held_opening.cpp
// among their sources. Thread: any. One at a time.
class HeldOpening {
 public:
  explicit HeldOpening(const std::string& path);
  ~HeldOpening();
  HeldOpening(const HeldOpening&) = delete;
  HeldOpening& operator=(const HeldOpening&) = delete;

  // How many wait in it now.
  [[nodiscard]] int waiting() const;
  void release();
};

}  // namespace thimble::test
