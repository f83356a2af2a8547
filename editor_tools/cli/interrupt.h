// Ctrl-C and SIGTERM as a question that long work asks now and then, so that it can end cleanly.
#pragma once

namespace limber::cli {

// From now on the first SIGINT or SIGTERM only sets the flag; a second one ends the process.
void CatchInterrupts();

bool InterruptRequested();

}  // namespace limber::cli
