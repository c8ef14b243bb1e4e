// Compiled instead of gltf_draco.cpp where there is no libdraco.
#include "io/gltf/gltf_codecs.h"

namespace isoshell {

std::string decode_draco(DracoMesh&) {
  return " is packed by Draco, which this build cannot unpack; build with -DISOSHELL_DRACO=on (libdraco-dev), or write "
         "the file without this extension";
}

}  // namespace isoshell
