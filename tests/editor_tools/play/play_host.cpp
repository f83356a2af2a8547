// The player on a character made in code, as a program: what play_window_test drives.
//   play_host cylinder|square [--frames N] [--screenshot FILE]
#include "play_rigs.h"
#include "viewer/play_window.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#if defined(__SANITIZE_ADDRESS__)
// The Vulkan driver is unloaded at the end and takes the names of its few leaks along, so that they
// could not be told from ours; leaks are looked for where no driver is.
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0";
}
#endif

int main(int argc, char** argv) {
  using namespace limber;
  if (argc < 2) return 2;
  viewer::PlayOptions options;
  options.width = 640;
  options.height = 480;
  options.validation = true;
  for (int i = 2; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--frames") == 0) options.max_frames = std::atoi(argv[i + 1]);
    if (std::strcmp(argv[i], "--screenshot") == 0) options.screenshot_path = argv[i + 1];
  }
  const bool square = std::strcmp(argv[1], "square") == 0;
  const Status status =
      viewer::PlayRig(square ? test::BakeSquare() : test::BakeCylinder(), {}, options);
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", status.message().c_str());
  return 1;
}
