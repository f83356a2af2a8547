// What `bake` starts from: a character read from a glTF, and its handles from one of three places.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "import/raw_character.h"

#include <string>

namespace limber::cli {

struct HandleChoice {
  Vector<bake::HandleSpec> handles;
  std::string source;  // where they came from, for people: "the file knees.json"
};

// A handle file where one is given, else `num_auto` chosen ones where that is positive, else the
// nodes that the glTF marks. kNoHandles, naming the three ways, where that leaves none.
Result<HandleChoice> ChooseHandleSource(const bake::RawCharacter& raw,
                                        const std::string& handle_file, int num_auto);

}  // namespace limber::cli
