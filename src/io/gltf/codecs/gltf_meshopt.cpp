// Buffer views that meshoptimizer packed. Its decoders do not trust what they read; its filters trust their strides.
#include <meshoptimizer.h>

#include "io/gltf/gltf_codecs.h"

namespace isoshell {
namespace {

// The library has them as templates, too.
using Decode = int (*)(void*, size_t, size_t, const unsigned char*, size_t);
constexpr Decode kVertices = meshopt_decodeVertexBuffer, kTriangles = meshopt_decodeIndexBuffer,
                 kSequence = meshopt_decodeIndexSequence;

std::string must(const char* what, const std::string& is, const char* wanted) {
  return std::string(".") + what + " is " + is + "; it must be " + wanted;
}

/// Of what the specification asks of the numbers and names of a view.
std::string fault_of(const MeshoptView& v) {
  const std::string stride = std::to_string(v.stride);
  if (v.mode == "ATTRIBUTES") {
    if (v.stride < 4 || v.stride > 256 || v.stride % 4 != 0) return must("byteStride", stride, "4, 8, ... or 256");
    if (v.filter == "OCTAHEDRAL" && v.stride != 4 && v.stride != 8) return must("byteStride", stride, "4 or 8");
    if (v.filter == "QUATERNION" && v.stride != 8) return must("byteStride", stride, "8");
    return "";
  }
  if (v.mode != "TRIANGLES" && v.mode != "INDICES")
    return must("mode", "\"" + v.mode + "\"", "ATTRIBUTES, TRIANGLES or INDICES");
  if (v.stride != 2 && v.stride != 4) return must("byteStride", stride, "2 or 4");
  if (v.filter != "NONE") return must("filter", "\"" + v.filter + "\"", "NONE, as that of all indices");
  if (v.mode == "TRIANGLES" && v.count % 3 != 0) return must("count", std::to_string(v.count), "a multiple of 3");
  return "";
}

}  // namespace

std::string decode_meshopt(MeshoptView& v) {
  if (const std::string fault = fault_of(v); !fault.empty()) return fault;
  const auto count = size_t(v.count), stride = size_t(v.stride), bytes = size_t(v.packed.size);
  const auto* const packed = reinterpret_cast<const unsigned char*>(v.packed.data);
  v.values.resize(count * stride);
  char* const out = v.values.data();
  const Decode decode = v.mode == "ATTRIBUTES" ? kVertices : v.mode == "TRIANGLES" ? kTriangles : kSequence;
  if (count > 0 && decode(out, count, stride, packed, bytes) != 0)
    return " is not what meshoptimizer's decoder of " + v.mode + " takes for " + std::to_string(count) +
           " elements of " + std::to_string(stride) + " bytes; restore the file";
  if (v.filter == "OCTAHEDRAL")
    meshopt_decodeFilterOct(out, count, stride);
  else if (v.filter == "QUATERNION")
    meshopt_decodeFilterQuat(out, count, stride);
  else if (v.filter == "EXPONENTIAL")
    meshopt_decodeFilterExp(out, count, stride);
  else if (v.filter != "NONE")
    return must("filter", "\"" + v.filter + "\"", "NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL");
  return "";
}

}  // namespace isoshell
