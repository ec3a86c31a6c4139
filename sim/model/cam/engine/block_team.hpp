#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace thimble::sim::cam {

// Does a piece of work for each block of a scan, on the caller's thread and on others that stand
// by. A member that comes late finds the blocks done: nobody waits for a thread to wake up.
//
// Thread: one caller at a time. Not RT: members look for work for some 20 us before they sleep.
// Errors: none; the constructor throws what std::thread does where no thread is left.
class BlockTeam {
 public:
  // `member` is below size(), another one for each thread; 0 is the caller.
  using Work = std::function<void(std::size_t member, std::size_t block)>;

  // A team of one has no thread. At least one.
  explicit BlockTeam(std::size_t members);
  ~BlockTeam();
  BlockTeam(const BlockTeam&) = delete;
  BlockTeam& operator=(const BlockTeam&) = delete;

  [[nodiscard]] std::size_t size() const noexcept { return threads_.size() + 1; }
  // Calls `work` once for each block below `blocks`, in any order, and returns when all are over.
  // What they wrote can be read then. Work must not throw.
  void run(std::size_t blocks, const Work& work);

 private:
  // Blocks that a member does first, and others once theirs are done.
  struct alignas(64) Share {
    std::atomic<std::size_t> next{0};
    std::size_t end{0};
  };

  void end();
  void stand_by(std::size_t member);
  [[nodiscard]] bool await_scan(std::uint64_t last);
  void take_blocks(std::size_t member, const Work& work);

  std::mutex mutex_;
  std::condition_variable called_;       // there is a scan, or it is over for good
  std::condition_variable left_;         // the last member has left
  std::atomic<std::uint64_t> scans_{0};  // begun; written under the mutex
  const Work* work_{nullptr};            // none: members that come now are too late
  std::atomic<std::size_t> busy_{0};     // members other than the caller; written under the mutex
  bool is_over_{false};
  std::vector<Share> shares_;  // by member
  std::vector<std::thread> threads_;
};

}  // namespace thimble::sim::cam
