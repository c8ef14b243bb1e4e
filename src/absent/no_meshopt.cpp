// Compiled instead of gltf_meshopt.cpp where there is no meshoptimizer.
#include "io/gltf/gltf_codecs.h"

namespace isoshell {

std::string decode_meshopt(MeshoptView&) {
  return " is packed by meshoptimizer, which this build cannot unpack; build with -DISOSHELL_MESHOPT=on "
         "(libmeshoptimizer-dev), or write the file without this extension";
}

}  // namespace isoshell
