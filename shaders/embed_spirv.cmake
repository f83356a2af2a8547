# cmake -DSPIRV=<in> -DHEADER=<out> -DNAME=<snake_case> -P embed_spirv.cmake
# Writes a SPIR-V file as a C++ array of little-endian 32-bit words.
file(READ ${SPIRV} hex HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${hex}")
string(REGEX REPLACE "((0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,))"
       "\\1\n" words "${words}")
set(camel "")
string(REPLACE "_" ";" parts ${NAME})
foreach(part ${parts})
  string(SUBSTRING ${part} 0 1 head)
  string(SUBSTRING ${part} 1 -1 tail)
  string(TOUPPER ${head} head)
  string(APPEND camel ${head}${tail})
endforeach()
file(WRITE ${HEADER}
"// Made at build time from GLSL; do not edit.
#pragma once

#include <cstdint>

namespace limber::shaders {

inline constexpr uint32_t k${camel}Spirv[] = {
${words}
};

}  // namespace limber::shaders
")
