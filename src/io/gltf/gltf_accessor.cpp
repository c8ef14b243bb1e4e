// The elements of accessors as numbers.

#include <algorithm>
#include <type_traits>

#include "core/number_type.h"
#include "core/parallel_ranges.h"
#include "io/bytes/byte_order.h"
#include "io/gltf/gltf_document.h"

namespace isoshell {
namespace {

constexpr int64_t kGrain = 1 << 14;

/// Calls visit with the number of components, of 1 to 4, as a constant: loops over them are unrolled.
template <class Visit>
void with_components(int32_t components, Visit visit) {
  if (components == 1) visit(std::integral_constant<int64_t, 1>());
  if (components == 2) visit(std::integral_constant<int64_t, 2>());
  if (components == 3) visit(std::integral_constant<int64_t, 3>());
  if (components == 4) visit(std::integral_constant<int64_t, 4>());
}

/// Puts what `convert` makes of the components of all elements one behind the other. Elements have at most 4.
template <class Out, class Convert>
void convert_all(const GltfElements& e, Convert convert, Out* out) {
  if (!e.data) return;
  with_type(e.type, [&](auto number) {
    using T = decltype(number);
    constexpr auto kBytes = int64_t(sizeof(T));
    if constexpr (kBytes <= 4)
      with_components(e.components, [&](auto components) {
        constexpr int64_t kCount = components;
        const bool is_packed = e.stride == kCount * kBytes;
        for_ranges(e.count, kGrain, [&](int64_t begin, int64_t end) {
          if (is_packed)
            for (int64_t v = begin * kCount; v < end * kCount; ++v)
              out[v] = convert(load_little_endian<T>(e.data + v * kBytes));
          else
            for (int64_t i = begin; i < end; ++i)
              for (int64_t c = 0; c < kCount; ++c)
                out[i * kCount + c] = convert(load_little_endian<T>(e.data + i * e.stride + c * kBytes));
        });
      });
  });
}

/// Which elements a sparse accessor replaces, all in range.
std::vector<uint32_t> replaced_of(const GltfDocument& document, const GltfAccessor& a) {
  std::vector<uint32_t> replaced;
  resize_counted(document.source(), replaced, size_t(a.replaced.count));
  convert_all(
      a.replaced, [](auto value) { return uint32_t(value); }, replaced.data());
  for (const uint32_t i : replaced)
    if (i >= a.count)
      document.refuse(a.replaced.place,
                      " names element " + std::to_string(i) + "; the accessor has " + std::to_string(a.count));
  return replaced;
}

template <class Out, class Convert>
void read(const GltfDocument& document, const GltfAccessor& a, Convert convert, Out* out) {
  const auto components = size_t(a.components);
  if (!a.data) std::fill_n(out, size_t(a.count) * components, Out(0));
  convert_all(a, convert, out);
  std::vector<uint32_t> replaced = replaced_of(document, a);
  std::vector<Out> values;
  resize_counted(document.source(), values, replaced.size() * components);
  convert_all(a.replacements, convert, values.data());
  // One after another: a file may name an element twice.
  for (size_t i = 0; i < replaced.size(); ++i)
    std::copy_n(&values[i * components], components, out + replaced[i] * components);
  release(document.source(), replaced);
  release(document.source(), values);
}

}  // namespace

template <class Real>
void read_values(const GltfDocument& document, const GltfAccessor& a, bool scaled, Real* out) {
  const auto convert = [scaled = scaled && a.normalized](auto value) {
    using T = decltype(value);
    if (std::is_integral_v<T> && scaled)
      return Real(std::max(double(value) / double(std::numeric_limits<T>::max()), -1.0));
    return Real(value);
  };
  read(document, a, convert, out);
}

template void read_values(const GltfDocument&, const GltfAccessor&, bool, float*);
template void read_values(const GltfDocument&, const GltfAccessor&, bool, double*);

void read_indices(const GltfDocument& document, const GltfAccessor& a, uint32_t* out) {
  const bool is_index = a.type == NumberType::u8 || a.type == NumberType::u16 || a.type == NumberType::u32;
  if (a.components != 1 || !is_index)
    document.refuse(a.place, " holds no indices; they are SCALAR, of componentType 5121, 5123 or 5125");
  read(
      document, a, [](auto value) { return uint32_t(value); }, out);
}

}  // namespace isoshell
