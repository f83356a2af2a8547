// Counts every allocation of the test program, to prove that a piece of code makes none.
#pragma once

#include <cstdint>

namespace limber::test {

// Allocations of this thread so far: operator new, and malloc and its kin as well (Eigen calls
// those), except under AddressSanitizer, which owns malloc.
int64_t AllocationCount();

// Bytes asked for by those; what was freed since stays counted.
int64_t AllocatedBytes();

}  // namespace limber::test
