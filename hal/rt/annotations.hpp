#pragma once

// Real-time class of a function, for readers and for tests/lint:
//   THIMBLE_RT      bounded; no system call, allocation, lock, exception, log or unbounded loop
//   THIMBLE_RT_IO   bounded; may make the one system call that its comment names
// Everything without a mark is for the control and net planes.
#define THIMBLE_RT
#define THIMBLE_RT_IO
