#pragma once

#include <functional>
#include <memory>
#include <thread>

#include "hal/base/time.hpp"

namespace thimble::linux {

// A thread for work that may wait for a disk, or for who reads a pipe: one task after the other.
// What hangs holds up neither its owner nor the end of the process.
//
// Thread: one owner. Not RT.
// Ownership: a task owns all that it uses, or who posts it calls finish() before that goes: where
//            one hangs while the worker is destroyed, it is left alone with it until the process
//            ends. What it owned ends in the worker's thread.
// Errors: a task tells of its own; one that throws has ended, and nobody hears of what it threw.
class BackgroundWorker {
 public:
  using Task = std::function<void()>;

  BackgroundWorker();
  // Does not wait: what is under way, or is next, is still done, and nothing after it.
  ~BackgroundWorker();
  BackgroundWorker(const BackgroundWorker&) = delete;
  BackgroundWorker& operator=(const BackgroundWorker&) = delete;

  // Returns at once.
  void post(Task task);
  // Whether all that was posted is done within `patience`, and gone with what it owned; more may be
  // posted afterwards.
  [[nodiscard]] bool wait(Duration patience);
  // The same, however long it takes: before what a task uses goes away.
  void finish();

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
  std::thread thread_;
};

}  // namespace thimble::linux
