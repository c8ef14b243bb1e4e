// The JSON of a glTF file and its buffers: nothing of it is used before it is checked.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/bytes/mesh_source.h"
#include "isoshell/attribute.h"

namespace isoshell {

/// Elements of a buffer; a sparse accessor replaces some of them.
struct GltfElements {
  const char* data = nullptr;  ///< null: zeros
  int64_t count = 0, stride = 0;
  NumberType type = NumberType::f32;
  int32_t components = 1;
  bool normalized = false;  ///< integers are parts of the largest value of their type
  std::string place;        ///< as "accessors[4]"
};
struct GltfAccessor : GltfElements {
  GltfElements replaced, replacements;  ///< of equal count: numbers of elements, all in range, and what they become
};

/// A .glb or .gltf file, told apart by its first bytes. Every member throws unreadable_input for what is not as the
/// specification says, with the file, the place, the value and the limit. Results point into the document.
class GltfDocument {
 public:
  using Json = nlohmann::json;

  explicit GltfDocument(const MeshSource& source);

  const MeshSource& source() const { return source_; }
  const Json& json() const { return json_; }
  Json& json() { return json_; }
  /// Whether extensionsRequired names it.
  bool requires_extension(const std::string& name) const;
  /// How many bytes of the file stand behind the length that its header has.
  int64_t surplus_bytes() const { return surplus_bytes_; }

  [[noreturn]] void refuse(const std::string& place, const std::string& what) const { source_.refuse(place + what); }

  /// A list of the whole document, or of an object of it; an empty one where it is missing.
  const Json& list(const Json& object, const char* key, const std::string& place = "") const;
  /// An element of a list of the whole document, which is an object. `from` says where the index stands.
  const Json& element(const char* array, int64_t index, const std::string& from) const;
  std::optional<int64_t> integer(const Json& object, const char* key, const std::string& place) const;
  int64_t needed_integer(const Json& object, const char* key, const std::string& place) const;
  /// Fills `values` if the key is there.
  bool numbers(const Json& object, const char* key, const std::string& place, double* values, size_t count) const;

  GltfAccessor accessor(int64_t index, const std::string& from) const;
  /// An accessor without its data, as it says that they are.
  GltfAccessor described(int64_t index, const std::string& from) const;
  View<const char> bytes_of_view(int64_t index, const std::string& from) const;
  /// Those that an object says by buffer, byteOffset and byteLength.
  View<const char> bytes_in_buffer(const Json& object, const std::string& place) const;
  /// Whether a buffer is no mere place that an extension's data unpack to.
  bool has_data(int64_t buffer) const;
  /// Result: the number of a new buffer, in the JSON, too.
  size_t add_buffer(std::vector<char> bytes);
  /// Of all buffers.
  int64_t bytes() const { return bytes_; }
  /// How many elements an accessor says that it has, which is not checked and so no more than a hint of how much memory
  /// to reserve: from 0 to bytes().
  int64_t claimed_count(int64_t index) const;

 private:
  void read_container();
  void check_version();
  void check_extensions() const;
  void read_buffers();
  View<const char> bytes_of_uri(const std::string& uri, const std::string& place);
  /// Those of `object` in a buffer view; `e` has all but data and stride. Those of sparse accessors are packed.
  void place_elements(const Json& object, int64_t view, bool packed, GltfElements& e) const;
  void read_sparse(const Json& sparse, GltfAccessor& accessor) const;

  const MeshSource& source_;
  Json json_;
  std::optional<View<const char>> chunk_;  ///< the binary one of a .glb file
  std::vector<View<const char>> buffers_;
  std::vector<std::unique_ptr<MeshSource>> files_;
  std::vector<std::vector<char>> decoded_;
  int64_t surplus_bytes_ = 0, bytes_ = 0;  ///< bytes_: of all buffers
};

int64_t bytes_of(NumberType type);

/// The values of all elements; normalised integers as they stand unless `scaled`. Real: float, double.
template <class Real>
void read_values(const GltfDocument& document, const GltfAccessor& accessor, bool scaled, Real* out);
/// Whole numbers.
void read_indices(const GltfDocument& document, const GltfAccessor& accessor, uint32_t* out);

}  // namespace isoshell
