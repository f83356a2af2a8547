// Counts every allocation of the test program, to prove that a piece of code makes none.
#pragma once

#include <cstdint>

namespace limber::test {

// Allocations of this thread so far: operator new, and malloc and its kin as well (Eigen calls
// those), except under AddressSanitizer, which owns malloc.
int64_t AllocationCount();

// Bytes asked for by those; what was freed since stays counted.
int64_t AllocatedBytes();

// Allocations of this thread less what it freed, of whichever thread.
int64_t LiveAllocations();

// While it lives, this thread is not counted: for what the test itself does meanwhile.
class NotCounted {
 public:
  NotCounted();
  NotCounted(const NotCounted&) = delete;
  NotCounted& operator=(const NotCounted&) = delete;
  ~NotCounted();

 private:
  int64_t count_, bytes_, freed_;
};

}  // namespace limber::test
