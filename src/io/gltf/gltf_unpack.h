// What extensions of glTF pack, unpacked.
#pragma once

#include "io/gltf/gltf_document.h"

namespace isoshell {

/// Makes a document as if what is read of it had been stored plainly: buffer views of EXT_meshopt_compression become
/// those of new buffers, and primitives of KHR_draco_mesh_compression get accessors of new buffers. What stands in the
/// file plainly, too, is left as it is, unless the file requires the extension. Throws: as the document's members.
void unpack(GltfDocument& document);

}  // namespace isoshell
