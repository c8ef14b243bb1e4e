// A build without Draco refuses what it packed.
#include "io/gltf/gltf_codecs.h"
#include "support/catch.h"

using namespace isoshell;

TEST_CASE("glTF: a build without Draco says what is missing and what to do", "[mesh_file][unit]") {
  DracoMesh packed{};
  const std::string fault = decode_draco(packed);
  INFO(fault);
  CHECK(fault.find("-DISOSHELL_DRACO=on (libdraco-dev)") != std::string::npos);
}
