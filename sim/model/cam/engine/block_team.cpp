#include "sim/model/cam/engine/block_team.hpp"

namespace thimble::sim::cam {
namespace {

// SOURCE: ours; 20 to 40 us, about as long as a sleeping thread takes to be woken.
constexpr int kLooks = 2000;

// Leaves the processor's core to whoever shares it, for some ten nanoseconds.
void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

BlockTeam::BlockTeam(std::size_t members) : shares_(members) {
  try {
    for (std::size_t member = 1; member < members; ++member) {
      threads_.emplace_back([this, member] { stand_by(member); });
    }
  } catch (...) {
    end();
    throw;
  }
}

BlockTeam::~BlockTeam() { end(); }

void BlockTeam::end() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
    ++scans_;
  }
  called_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void BlockTeam::run(std::size_t blocks, const Work& work) {
  if (threads_.empty()) {
    for (std::size_t block = 0; block < blocks; ++block) work(0, block);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < shares_.size(); ++i) {
      shares_[i].next = blocks * i / shares_.size();
      shares_[i].end = blocks * (i + 1) / shares_.size();
    }
    work_ = &work;
    ++scans_;
  }
  called_.notify_all();
  take_blocks(0, work);
  {
    const std::lock_guard lock(mutex_);
    work_ = nullptr;
  }
  for (int look = 0; look < kLooks && busy_ != 0; ++look) pause();
  std::unique_lock lock(mutex_);
  left_.wait(lock, [this] { return busy_ == 0; });
}

void BlockTeam::stand_by(std::size_t member) {
  for (std::uint64_t last = 0;;) {
    if (!await_scan(last)) return;
    const Work* work = nullptr;
    {
      const std::lock_guard lock(mutex_);
      last = scans_;
      if (work_ == nullptr) continue;
      work = work_;
      ++busy_;
    }
    take_blocks(member, *work);
    const std::lock_guard lock(mutex_);
    if (--busy_ == 0) left_.notify_one();
  }
}

// False when the team is over.
bool BlockTeam::await_scan(std::uint64_t last) {
  for (int look = 0; look < kLooks && scans_ == last; ++look) pause();
  std::unique_lock lock(mutex_);
  // The end may have come with a scan that this member saw before it.
  called_.wait(lock, [&] { return is_over_ || scans_ != last; });
  return !is_over_;
}

// Its own first: they are in its processor's cache from the scan before.
void BlockTeam::take_blocks(std::size_t member, const Work& work) {
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    Share& share = shares_[(member + i) % shares_.size()];
    for (std::size_t block = share.next++; block < share.end; block = share.next++) {
      work(member, block);
    }
  }
}

}  // namespace thimble::sim::cam
