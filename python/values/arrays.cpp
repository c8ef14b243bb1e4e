#include "values/arrays.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "isoshell/error.h"
#include "isoshell/io/mesh_view.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

static_assert(sizeof(WorldPoint) == 3 * sizeof(double), "vertices are shown as rows of three doubles");

using DlpackCode = nb::dlpack::dtype_code;

[[noreturn]] void refuse(const char* argument, const std::string& what) {
  throw Error(ErrorCode::usage, "arguments", std::string(argument) + what);
}

std::string shape_text(const AnyArray& a) {
  std::string text;
  for (size_t i = 0; i < a.ndim(); ++i) text += (i ? ", " : "") + std::to_string(a.shape(i));
  return "(" + text + (a.ndim() == 1 ? ",)" : ")");
}

std::string type_text(const nb::dlpack::dtype& type) {
  const char* kind = "values";
  if (type.code == uint8_t(DlpackCode::Float)) kind = "float";
  if (type.code == uint8_t(DlpackCode::Int)) kind = "int";
  if (type.code == uint8_t(DlpackCode::UInt)) kind = "uint";
  if (type.code == uint8_t(DlpackCode::Bool)) kind = "bool";
  if (type.code == uint8_t(DlpackCode::Complex)) kind = "complex";
  return kind + std::to_string(type.bits);
}

bool is(const nb::dlpack::dtype& type, DlpackCode code, int bits) {
  return type.code == uint8_t(code) && type.bits == bits && type.lanes == 1;
}

/// Calls work(zero) with a zero of the array's type. False where it is of none of these.
template <class Work>
bool of_whole_type(const AnyArray& a, Work work) {
  const nb::dlpack::dtype type = a.dtype();
  if (is(type, DlpackCode::Int, 64)) return work(int64_t(0)), true;
  if (is(type, DlpackCode::Int, 32)) return work(int32_t(0)), true;
  if (is(type, DlpackCode::UInt, 32)) return work(uint32_t(0)), true;
  if (is(type, DlpackCode::UInt, 64)) return work(uint64_t(0)), true;
  if (is(type, DlpackCode::Int, 16)) return work(int16_t(0)), true;
  if (is(type, DlpackCode::UInt, 16)) return work(uint16_t(0)), true;
  if (is(type, DlpackCode::Int, 8)) return work(int8_t(0)), true;
  if (is(type, DlpackCode::UInt, 8)) return work(uint8_t(0)), true;
  return false;
}

/// The library's name of the array's type. `needed` is what the refusal asks for.
ElementType element_type(const char* argument, const AnyArray& a, const char* needed) {
  if (is(a.dtype(), DlpackCode::Float, 64)) return ElementType::f64;
  if (is(a.dtype(), DlpackCode::Float, 32)) return ElementType::f32;
  ElementType type{};
  if (!of_whole_type(a, [&](auto zero) { type = element_type_of<decltype(zero)>(); }))
    refuse(argument, std::string(" must be ") + needed + ", and is " + type_text(a.dtype()));
  return type;
}

constexpr char kNumbers[] = "numbers, such as float32 or float64";
constexpr char kWholeNumbers[] = "whole numbers, such as int32 or int64";

/// An array of one or two dimensions, as what is read without the interpreter's lock.
RowsView view_of(const char* argument, const AnyArray& a, const char* needed) {
  const bool has_columns = a.ndim() == 2;
  const ElementType type = element_type(argument, a, needed);
  const int64_t bytes = a.dtype().bits / 8;
  return {a.data(),
          type,
          int64_t(a.shape(0)),
          has_columns ? int64_t(a.shape(1)) : 1,
          a.stride(0) * bytes,
          has_columns ? a.stride(1) * bytes : 0};
}

RowsView view_of_threes(const char* argument, const AnyArray& a, const char* needed) {
  if (a.ndim() != 2 || a.shape(1) != 3)
    refuse(argument, " must be rows of three, of the shape (K, 3), and has the shape " + shape_text(a));
  return view_of(argument, a, needed);
}

[[noreturn]] void refuse_label(const char* argument, size_t i, size_t j, size_t k, const std::string& value) {
  refuse(argument, "[" + std::to_string(i) + ", " + std::to_string(j) + ", " + std::to_string(k) + "] is " + value +
                       "; labels are whole numbers from " + std::to_string(INT32_MIN) + " to " +
                       std::to_string(INT32_MAX) + ": number the regions anew");
}

template <class T>
bool fits_32_bits(T value) {
  if constexpr (std::is_signed_v<T>)
    return int64_t(value) >= INT32_MIN && int64_t(value) <= INT32_MAX;
  else
    return uint64_t(value) <= uint64_t(INT32_MAX);
}

template <class T>
void copy_labels(const char* argument, const AnyArray& a, int32_t* to) {
  const auto* const bytes = static_cast<const std::byte*>(a.data());
  size_t at = 0;
  for (size_t k = 0; k < a.shape(2); ++k)
    for (size_t j = 0; j < a.shape(1); ++j)
      for (size_t i = 0; i < a.shape(0); ++i) {
        T value;
        const int64_t place = int64_t(i) * a.stride(0) + int64_t(j) * a.stride(1) + int64_t(k) * a.stride(2);
        std::memcpy(&value, bytes + place * int64_t(sizeof(T)), sizeof(T));
        if (!fits_32_bits(value)) refuse_label(argument, i, j, k, std::to_string(value));
        to[at++] = int32_t(value);
      }
}

}  // namespace

std::vector<WorldPoint> points_of(const char* argument, const AnyArray& a) {
  const RowsView rows = view_of_threes(argument, a, kNumbers);
  const nb::gil_scoped_release released;
  return points_in(rows, argument);
}

std::vector<std::array<uint32_t, 3>> triangles_of(const char* argument, const AnyArray& a, size_t vertices) {
  const RowsView rows = view_of_threes(argument, a, kWholeNumbers);
  const nb::gil_scoped_release released;
  return triangles_in(rows, int64_t(vertices), argument);
}

std::vector<uint32_t> indices_of(const char* argument, const AnyArray& a, size_t end) {
  if (a.ndim() != 1) refuse(argument, " must be one row, and has the shape " + shape_text(a));
  const RowsView rows = view_of(argument, a, kWholeNumbers);
  const nb::gil_scoped_release released;
  return indices_in(rows, int64_t(end), argument);
}

std::vector<int32_t> labels_of(const char* argument, const AnyArray& a) {
  if (a.ndim() != 3) refuse(argument, " must have 3 dimensions, and has the shape " + shape_text(a));
  std::vector<int32_t> labels(a.shape(0) * a.shape(1) * a.shape(2));
  const bool known = of_whole_type(a, [&](auto zero) {
    using T = decltype(zero);
    const nb::gil_scoped_release released;
    copy_labels<T>(argument, a, labels.data());
  });
  if (!known) refuse(argument, " must be whole numbers, such as uint8 or int32, and is " + type_text(a.dtype()));
  return labels;
}

const float* floats_of(const char* argument, const AnyArray& a, size_t dimensions) {
  if (a.ndim() != dimensions)
    refuse(argument, " must have " + std::to_string(dimensions) + " dimensions, and has the shape " + shape_text(a));
  if (!is(a.dtype(), DlpackCode::Float, 32)) refuse(argument, " must be float32 here, and is " + type_text(a.dtype()));
  return static_cast<const float*>(a.data());
}

Rows<double> rows_of(const std::vector<WorldPoint>& points, nb::handle owner) {
  return {reinterpret_cast<const double*>(points.data()), {points.size(), 3}, owner};
}

Rows<int32_t> rows_of(const std::vector<std::array<uint32_t, 3>>& triangles, nb::handle owner) {
  return {reinterpret_cast<const int32_t*>(triangles.data()), {triangles.size(), 3}, owner};
}

}  // namespace isoshell::python
