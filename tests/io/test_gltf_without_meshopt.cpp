// A build without meshoptimizer refuses what it packed.
#include "io/gltf/gltf_codecs.h"
#include "support/catch.h"

using namespace isoshell;

TEST_CASE("glTF: a build without meshoptimizer says what is missing and what to do", "[mesh_file][unit]") {
  MeshoptView packed{};
  const std::string fault = decode_meshopt(packed);
  INFO(fault);
  CHECK(fault.find("-DISOSHELL_MESHOPT=on (libmeshoptimizer-dev)") != std::string::npos);
}
