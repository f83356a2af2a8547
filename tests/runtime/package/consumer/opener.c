/* Opens the library at run time and calls it through a pointer: opener LIBRARY. */
#include <dlfcn.h>
#include <limber/limber.h>
#include <stdio.h>
#include <string.h>

int main(int argc, char** argv) {
  void* library;
  void* symbol;
  uint32_t (*get_version)(void);
  if (argc < 2) return 2;
  library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
  if (library == NULL) {
    fprintf(stderr, "%s\n", dlerror());
    return 1;
  }
  symbol = dlsym(library, "limberGetVersion");
  if (symbol == NULL) return 1;
  memcpy(&get_version, &symbol, sizeof symbol);
  if (get_version() != LIMBER_VERSION) return 1;
  puts("opened");
  return dlclose(library);
}
