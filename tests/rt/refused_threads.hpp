#pragma once

namespace thimble::test {

// While it lives, the thread that made it can start no thread whose stack it chooses, as a servo's:
// linking this stands in front of pthread_attr_setstacksize(). Other threads notice nothing.
class RefusedThreads {
 public:
  RefusedThreads() noexcept;
  ~RefusedThreads();
  RefusedThreads(const RefusedThreads&) = delete;
  RefusedThreads& operator=(const RefusedThreads&) = delete;
};

}  // namespace thimble::test
