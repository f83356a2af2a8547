// tinygltf, compiled here: whoever links liblimber needs no library beside it. CMakeLists.txt of
// this folder says what is left out, and gives its namespace another name.
#include <tiny_gltf.h>
