// Primitives that Draco packed, by libdraco.
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>

#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "core/number_type.h"
#include "core/parallel_ranges.h"
#include "io/gltf/gltf_codecs.h"

namespace isoshell {
namespace {

constexpr int64_t kGrain = 1 << 14;
constexpr uint16_t kBitstream = DRACO_BITSTREAM_VERSION(2, 2);  // the one that the extension is defined for
constexpr int kMostSeams = 32;                                  // attributes with a connectivity of their own

/// libdraco's decoders take memory for what the packed bytes say. Here they first say how much that is.
template <class Decoder>
class BoundedDecoder : public Decoder {
 public:
  explicit BoundedDecoder(const DracoMesh& limits) : limits_(limits) {}
  const std::string& excess() const { return excess_; }

 protected:
  bool DecodeConnectivity() override {
    constexpr bool is_edgebreaker = std::is_same_v<Decoder, draco::MeshEdgebreakerDecoder>;
    draco::DecoderBuffer ahead = *this->buffer();
    uint32_t triangles = 0, points = 0;  // of edgebreaker vertices, of which points are made where attributes jump
    uint8_t seams = 0;
    const bool is_there = draco::DecodeVarint(is_edgebreaker ? &points : &triangles, &ahead) &&
                          draco::DecodeVarint(is_edgebreaker ? &triangles : &points, &ahead) &&
                          (!is_edgebreaker || ahead.Decode(&seams));
    return is_there && is_most("triangles", triangles, limits_.most_triangles) &&
           is_most("points", points, limits_.most_points) && is_most("attributes with seams", seams, kMostSeams) &&
           Decoder::DecodeConnectivity();
  }

  bool DecodeAllAttributes() override {
    const draco::PointCloud& cloud = *this->point_cloud();
    const int64_t points = cloud.num_points();
    int64_t bytes = 0;  // of a point: its values, and the integers of 32 bits that they are packed as
    for (int i = 0; i < cloud.num_attributes(); ++i)
      bytes += cloud.attribute(i)->byte_stride() + 4 * cloud.attribute(i)->num_components();
    return is_most("points", points, limits_.most_points) &&
           (points == 0 || is_most("bytes a point", bytes, limits_.most_bytes / points)) &&
           Decoder::DecodeAllAttributes();
  }

 private:
  bool is_most(const char* what, int64_t count, int64_t most) {
    if (count <= most) return true;
    excess_ = " promises " + std::to_string(count) + " " + what + "; at most " + std::to_string(most) +
              " are read, as many as the accessors have, or a limit";
    return false;
  }

  const DracoMesh& limits_;
  std::string excess_;
};

template <class Decoder>
std::string decode_with(const DracoMesh& limits, draco::DecoderBuffer& buffer, draco::Mesh& mesh) {
  BoundedDecoder<Decoder> decoder(limits);
  const draco::DecoderOptions options;
  const draco::Status status = decoder.Decode(options, &buffer, &mesh);
  if (!decoder.excess().empty()) return decoder.excess();
  return status.ok() ? "" : " cannot be unpacked (" + status.error_msg_string() + "); restore the file";
}

std::string decode(const DracoMesh& limits, draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(limits.packed.data, size_t(limits.packed.size));
  draco::DecoderBuffer ahead = buffer;
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&ahead, &header).ok())
    return " does not begin as Draco's data do; restore the file";
  const int version = DRACO_BITSTREAM_VERSION(header.version_major, header.version_minor);
  if (version != kBitstream)
    return " has version " + std::to_string(header.version_major) + "." + std::to_string(header.version_minor) +
           " of Draco's data; only 2.2 can be read";
  if (header.encoder_type != draco::TRIANGULAR_MESH) return " holds no triangles; write it as triangles";
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
    return decode_with<draco::MeshEdgebreakerDecoder>(limits, buffer, mesh);
  if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
    return decode_with<draco::MeshSequentialDecoder>(limits, buffer, mesh);
  return " is packed by method " + std::to_string(header.encoder_method) + "; only 0 and 1 can be read";
}

/// Whether every point has a value of the attribute.
bool is_whole(const draco::PointAttribute& attribute, int64_t points) {
  const auto size = int64_t(attribute.size());
  if (size * attribute.byte_stride() > int64_t(attribute.buffer()->data_size())) return false;
  if (attribute.is_mapping_identity()) return points <= size;
  return int64_t(attribute.indices_map_size()) >= points &&
         sum_over_ranges(points, kGrain, [&](int64_t begin, int64_t end) {
           int64_t wrong = 0;
           for (int64_t p = begin; p < end; ++p)
             wrong += attribute.mapped_index(draco::PointIndex(uint32_t(p))).value() >= size;
           return wrong;
         }) == 0;
}

/// The values of all points, converted where Draco has them as another type; empty where one cannot be.
template <class T>
std::vector<char> values_of(const draco::PointAttribute& attribute, int64_t points, draco::DataType type) {
  const size_t components = attribute.num_components(), bytes = components * sizeof(T);
  std::vector<char> values(size_t(points) * bytes);
  const bool is_same = attribute.data_type() == type;
  const int64_t wrong = sum_over_ranges(points, kGrain, [&](int64_t begin, int64_t end) {
    T value[16] = {};  // accessors have no more components; a failed conversion leaves some of them as they were
    int64_t failed = 0;
    for (int64_t p = begin; p < end; ++p) {
      const auto at = attribute.mapped_index(draco::PointIndex(uint32_t(p)));
      const void* from = value;
      if (is_same)
        from = attribute.GetAddress(at);
      else
        failed += !attribute.ConvertValue<T>(at, value);
      std::memcpy(&values[size_t(p) * bytes], from, bytes);
    }
    return failed;
  });
  if (wrong > 0) values.clear();
  return values;
}

std::vector<char> values_as(NumberType type, const draco::PointAttribute& attribute, int64_t points) {
  switch (type) {
    case NumberType::i8:
      return values_of<int8_t>(attribute, points, draco::DT_INT8);
    case NumberType::u8:
      return values_of<uint8_t>(attribute, points, draco::DT_UINT8);
    case NumberType::i16:
      return values_of<int16_t>(attribute, points, draco::DT_INT16);
    case NumberType::u16:
      return values_of<uint16_t>(attribute, points, draco::DT_UINT16);
    case NumberType::u32:
      return values_of<uint32_t>(attribute, points, draco::DT_UINT32);
    default:  // accessors have no others
      return values_of<float>(attribute, points, draco::DT_FLOAT32);
  }
}

std::string read(const draco::Mesh& mesh, DracoMesh& out) {
  out.points = mesh.num_points();
  for (DracoMesh::Attribute& wanted : out.attributes) {
    const std::string which = " has for attribute " + std::to_string(wanted.id) + " ";
    const bool is_id = wanted.id <= std::numeric_limits<uint32_t>::max();
    const draco::PointAttribute* const found = is_id ? mesh.GetAttributeByUniqueId(uint32_t(wanted.id)) : nullptr;
    if (!found) return which + "no data; restore the file";
    if (found->num_components() != wanted.components)
      return which + std::to_string(found->num_components()) + " components; its accessor has " +
             std::to_string(wanted.components);
    if (!is_whole(*found, out.points)) return which + "not a value for every point; restore the file";
    wanted.values = values_as(wanted.type, *found, out.points);
    if (wanted.values.empty() && out.points > 0) return which + "values that its accessor's componentType cannot hold";
  }
  out.indices.resize(size_t(mesh.num_faces()) * 12);
  for_ranges(mesh.num_faces(), kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t t = begin; t < end; ++t)
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t point = mesh.face(draco::FaceIndex(uint32_t(t)))[k].value();
        std::memcpy(&out.indices[size_t(t) * 12 + 4 * k], &point, 4);
      }
  });
  return "";
}

}  // namespace

std::string decode_draco(DracoMesh& mesh) {
  try {
    draco::Mesh decoded;
    const std::string fault = decode(mesh, decoded);
    return fault.empty() ? read(decoded, mesh) : fault;
  } catch (const std::length_error&) {
    return " promises more than memory can hold; restore the file";
  }
}

}  // namespace isoshell
