// Counts every operator new of the test program, to prove that a piece of code allocates nothing.
#pragma once

#include <cstdint>

namespace limber::test {

// Number of operator new calls of this thread so far.
int64_t AllocationCount();

}  // namespace limber::test
