#include "core/attribute_values.h"

#include <algorithm>

namespace isoshell {

std::string misfit_of(const Attribute& a, size_t vertices, size_t triangles) {
  static constexpr const char* kElements[] = {"vertices", "corners", "faces"};
  const size_t counts[] = {vertices, 3 * triangles, triangles};
  const size_t count = counts[size_t(a.domain)];
  const std::string here = "the attribute '" + a.name + "' has ", elements = kElements[size_t(a.domain)];
  if (!a.index.empty() && (a.domain != AttributeDomain::corner || a.index.size() != count))
    return here + std::to_string(a.index.size()) + " indices; " + std::to_string(count) + " " + elements + " need " +
           (a.domain == AttributeDomain::corner ? "one each" : "none");
  const size_t values = a.index.empty() ? count : a.values.size() / size_t(std::max(a.components, 1));
  if (a.components < 1 || a.values.size() != values * size_t(a.components))
    return here + std::to_string(a.values.size()) + " values; " + std::to_string(values) + " " + elements + " need " +
           std::to_string(a.components) + " each";
  for (const uint32_t i : a.index)
    if (i >= values) return here + "the index " + std::to_string(i) + "; its values are " + std::to_string(values);
  for (const double number : a.values)
    if (!a.labels.empty() && !(number >= -1 && number < double(a.labels.size())))
      return here + "the number " + std::to_string(number) + "; its labels are " + std::to_string(a.labels.size());
  return "";
}

}  // namespace isoshell
