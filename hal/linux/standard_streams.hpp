#pragma once

#include "hal/base/result.hpp"

namespace thimble::linux {

// A program that is started with a closed standard descriptor gets its number for the next file,
// socket or device that it opens, and then writes there what was meant for a person. Takes those
// numbers first: writing to a closed standard output stays an error, what goes to a closed
// standard error is lost. Call it before anything is opened.
// Thread: the main one. Not RT.
void occupy_closed_standard_descriptors() noexcept;

// Writes what is still buffered and says whether all that was ever printed has gone out.
// Thread: the main one. Not RT. Errors: Disconnected when the reader of a pipe is gone (the
// program ignores SIGPIPE), else System; one sentence.
[[nodiscard]] Result<void> flush_standard_output();

}  // namespace thimble::linux
