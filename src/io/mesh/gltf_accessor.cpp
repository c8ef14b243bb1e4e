// The elements of accessors as numbers.

#include <algorithm>
#include <cstring>

#include "core/number_type.h"
#include "core/parallel_ranges.h"
#include "io/mesh/gltf_document.h"

namespace isoshell {
namespace {

constexpr int64_t kGrain = 1 << 14;

// Little-endian, on any machine.
template <class T>
T load(const char* p) {
  using Small = std::conditional_t<sizeof(T) == 1, uint8_t, uint16_t>;
  using Bits = std::conditional_t<sizeof(T) == 4, uint32_t, Small>;
  Bits bits = 0;
  for (size_t i = 0; i < sizeof(T); ++i) bits = Bits(bits | Bits(static_cast<unsigned char>(p[i])) << 8 * i);
  T value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// Calls take(number of the value, value) for all components of all elements; the type of values is the accessor's.
template <class Take>
void each_value(const GltfElements& e, Take take) {
  if (!e.data) return;
  with_type(e.type, [&](auto number) {
    using T = decltype(number);
    constexpr auto kBytes = int64_t(sizeof(T));
    if constexpr (kBytes <= 4) {
      const bool is_packed = e.stride == e.components * kBytes;
      for_ranges(e.count, kGrain, [&](int64_t begin, int64_t end) {
        if (is_packed)
          for (int64_t v = begin * e.components; v < end * e.components; ++v) take(v, load<T>(e.data + v * kBytes));
        else
          for (int64_t i = begin; i < end; ++i)
            for (int64_t c = 0; c < e.components; ++c)
              take(i * e.components + c, load<T>(e.data + i * e.stride + c * kBytes));
      });
    }
  });
}

/// Which elements a sparse accessor replaces, all in range.
std::vector<uint32_t> replaced_of(const GltfDocument& document, const GltfAccessor& a) {
  std::vector<uint32_t> replaced(size_t(a.replaced.count));
  each_value(a.replaced, [&](int64_t i, auto value) { replaced[size_t(i)] = uint32_t(value); });
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
  each_value(a, [&](int64_t i, auto value) { out[i] = convert(value); });
  const std::vector<uint32_t> replaced = replaced_of(document, a);
  std::vector<Out> values(replaced.size() * components);
  each_value(a.replacements, [&](int64_t i, auto value) { values[size_t(i)] = convert(value); });
  // One after another: a file may name an element twice.
  for (size_t i = 0; i < replaced.size(); ++i)
    std::copy_n(&values[i * components], components, out + replaced[i] * components);
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
