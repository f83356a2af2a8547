#include "cli/interrupt.h"

#include <csignal>

namespace limber::cli {
namespace {

volatile std::sig_atomic_t interrupt_requested = 0;

extern "C" void HandleInterrupt(int signal_number) {
  interrupt_requested = 1;
  std::signal(signal_number, SIG_DFL);
}

}  // namespace

void CatchInterrupts() {
  std::signal(SIGINT, HandleInterrupt);
  std::signal(SIGTERM, HandleInterrupt);
}

bool InterruptRequested() {
  return interrupt_requested != 0;
}

}  // namespace limber::cli
