// limber_make_content DIR: writes the characters that ship with Limber, and a scripted drag of
// each.
#include "generate/dragonlet.h"
#include "generate/fox.h"
#include "generate/square.h"
#include "generate/write_glb.h"

#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace {

using limber::content::Character;

// Beside its place first, then renamed: a reader never sees half a file.
bool WriteFile(const std::filesystem::path& path, const void* bytes, size_t size) {
  const std::filesystem::path beside = path.string() + ".part";
  std::FILE* file = std::fopen(beside.c_str(), "wb");
  bool good = file != nullptr && std::fwrite(bytes, 1, size, file) == size;
  good = file != nullptr && std::fclose(file) == 0 && good;
  std::error_code failed;
  if (good) std::filesystem::rename(beside, path, failed);
  if (good && !failed) return true;
  std::fprintf(stderr, "%s: cannot be written; check that the folder exists and has room\n",
               path.c_str());
  std::filesystem::remove(beside, failed);
  return false;
}

bool WriteCharacter(const std::filesystem::path& folder, const Character& character,
                    const std::string& drag) {
  const std::vector<uint8_t> glb = limber::content::WriteGlb(character);
  if (!WriteFile(folder / (character.name + ".glb"), glb.data(), glb.size()) ||
      !WriteFile(folder / (character.name + "_drag.json"), drag.data(), drag.size())) {
    return false;
  }
  std::printf("%s: %zu vertices, %zu shapes, %zu handles, %zu bytes\n", character.name.c_str(),
              character.normals.size(), character.shapes.size(), character.handles.size(),
              glb.size());
  return true;
}

int Main(int argc, char** argv) {
  if (argc != 2 || argv[1][0] == '-') {
    std::fprintf(stderr,
                 "usage: limber_make_content DIR\n"
                 "Writes the shipped characters and their scripted drags into DIR.\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const Character dragonlet = limber::content::MakeDragonlet();
  const Character fox = limber::content::MakeFox();
  const Character square = limber::content::MakeSquare();
  const bool good =
      WriteCharacter(folder, dragonlet, limber::content::MakeDragonletDrag(dragonlet)) &&
      WriteCharacter(folder, fox, limber::content::MakeFoxDrag(fox)) &&
      WriteCharacter(folder, square, limber::content::MakeSquareDrag(square));
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return Main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "limber_make_content: %s\n", error.what());
    return 1;
  }
}
