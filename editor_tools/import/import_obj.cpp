#include "import/import_obj.h"

#include "core/vector.h"
#include "import/json_input.h"
#include "load/gltf_limits.h"

#include <charconv>
#include <cmath>

namespace limber::bake {
namespace {

// Splits off the next word; empty at the end of the line.
std::string_view NextWord(std::string_view* line) {
  const size_t begin = line->find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) {
    *line = {};
    return {};
  }
  const size_t end = line->find_first_of(" \t\r", begin);
  const std::string_view word = line->substr(begin, end - begin);
  *line = end == std::string_view::npos ? std::string_view() : line->substr(end);
  return word;
}

std::string Quoted(std::string_view word) {
  std::string quoted(1, '"');
  return quoted.append(word).append(1, '"');
}

class ObjParser {
 public:
  explicit ObjParser(const std::string& name) { mesh_.file = name; }

  Result<ObjMesh> Parse(std::string_view text) {
    std::string joined;  // of lines that end in a backslash
    while (!text.empty()) {
      ++line_;
      const size_t end = text.find('\n');
      std::string_view line = text.substr(0, end);
      text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
      const size_t last = line.find_last_not_of(" \t\r");
      if (last != std::string_view::npos && line[last] == '\\') {
        joined += std::string(line.substr(0, last)) + " ";
        continue;
      }
      if (!joined.empty()) {
        joined += line;
        line = joined;
      }
      LIMBER_RETURN_IF_ERROR(ParseLine(line.substr(0, line.find('#'))));
      joined.clear();
    }
    if (mesh_.positions.empty() || mesh_.face_sizes.empty()) {
      return Status(StatusCode::kMalformed, mesh_.file + ": it has no vertex or no face");
    }
    return std::move(mesh_);
  }

 private:
  Status Fail(const std::string& reason, StatusCode code = StatusCode::kMalformed) const {
    return Status(code, mesh_.file + ":" + std::to_string(line_) + ": " + reason);
  }

  Status ParseLine(std::string_view line) {
    const std::string_view keyword = NextWord(&line);
    if (keyword == "v") return ParseNumbers(line, &mesh_.positions);
    if (keyword == "vt") return ParseNumbers(line, &mesh_.texcoords);
    if (keyword == "vn") return ParseNumbers(line, &mesh_.normals);
    return keyword == "f" ? ParseFace(line) : Status();
  }

  // Numbers beyond those wanted (a fourth coordinate, colours) are left alone.
  template <class T, size_t N>
  Status ParseNumbers(std::string_view line, Vector<std::array<T, N>>* items) {
    if (items->size() >= GltfLimits().max_vertices) {
      return Fail("more than " + std::to_string(GltfLimits().max_vertices) + " vertices",
                  StatusCode::kLimitExceeded);
    }
    std::array<T, N> item = {};
    for (size_t i = 0; i < N; ++i) {
      std::string_view word = NextWord(&line);
      // One texture coordinate is enough for OBJ.
      if (word.empty() && N == 2 && i == 1) break;
      if (!word.empty() && word.front() == '+') word.remove_prefix(1);
      double number = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
      const bool too_small =
          error == std::errc::result_out_of_range && word.find("e-") != word.npos;
      if (too_small) number = 0;
      if ((error != std::errc() && !too_small) || end != word.data() + word.size() ||
          !std::isfinite(static_cast<float>(number))) {
        return Fail(word.empty() ? std::to_string(N) + " numbers are needed"
                                 : Quoted(word) + " is not a finite number");
      }
      item[i] = static_cast<T>(number);
    }
    items->push_back(item);
    return {};
  }

  // One of "7", "-1": from 1 up, or counted back from the newest. Empty: none.
  Status ParseIndex(std::string_view word, size_t count, const char* what, int64_t* index) const {
    *index = -1;
    if (word.empty()) return {};
    int64_t number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    const auto total = static_cast<int64_t>(count);
    if (error != std::errc() || end != word.data() + word.size()) {
      return Fail(Quoted(word) + " is not an index");
    }
    *index = number < 0 ? total + number : number - 1;
    if (number == 0 || *index < 0 || *index >= total) {
      return Fail(std::string(what) + " " + std::string(word) + " of a face, and the file has " +
                  std::to_string(total) + " so far");
    }
    return {};
  }

  Status ParseFace(std::string_view line) {
    uint32_t size = 0;
    for (std::string_view word = NextWord(&line); !word.empty(); word = NextWord(&line)) {
      std::string_view parts[3];
      for (std::string_view& part : parts) {
        const size_t slash = word.find('/');
        part = word.substr(0, slash);
        word = slash == std::string_view::npos ? std::string_view() : word.substr(slash + 1);
      }
      if (!word.empty() || parts[0].empty()) return Fail("a corner that is not v/vt/vn");
      int64_t position = 0, texcoord = 0, normal = 0;
      LIMBER_RETURN_IF_ERROR(ParseIndex(parts[0], mesh_.positions.size(), "vertex", &position));
      LIMBER_RETURN_IF_ERROR(
          ParseIndex(parts[1], mesh_.texcoords.size(), "texture coordinate", &texcoord));
      LIMBER_RETURN_IF_ERROR(ParseIndex(parts[2], mesh_.normals.size(), "normal", &normal));
      mesh_.corners.push_back({static_cast<uint32_t>(position), static_cast<int32_t>(texcoord),
                               static_cast<int32_t>(normal)});
      ++size;
    }
    if (size < 3) return Fail("a face of " + std::to_string(size) + " corners");
    if (mesh_.corners.size() > 3 * GltfLimits().max_triangles) {
      return Fail("too many faces", StatusCode::kLimitExceeded);
    }
    mesh_.face_sizes.push_back(size);
    return {};
  }

  ObjMesh mesh_;
  size_t line_ = 0;
};

}  // namespace

Result<ObjMesh> ParseObj(std::string_view text, const std::string& name) {
  return ObjParser(name).Parse(text);
}

Result<ObjMesh> ReadObj(const std::filesystem::path& path) {
  Result<std::string> text = ReadTextFile(path);
  if (!text.ok()) return text.status();
  return ParseObj(*text, path.string());
}

}  // namespace limber::bake
