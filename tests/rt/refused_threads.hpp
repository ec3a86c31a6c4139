#pragma once

namespace thimble::test {

// While it lives, the thread that made it can start no thread: linking this stands in front of
// pthread_create(). Other threads notice nothing.
class RefusedThreads {
 public:
  enum class Which {
    All,
    WithAttributes,  // as a servo's, whose stack is chosen; not those of std::thread
  };
  explicit RefusedThreads(Which which) noexcept;
  ~RefusedThreads();
  RefusedThreads(const RefusedThreads&) = delete;
  RefusedThreads& operator=(const RefusedThreads&) = delete;
};

}  // namespace thimble::test
