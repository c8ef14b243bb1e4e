// Arrays of Python as values of the library, copied once, straight to where they stay; and back without a copy.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell::python {

/// An array in the host's memory, of any type, shape and strides.
using AnyArray = nanobind::ndarray<nanobind::ro, nanobind::device::cpu>;

/// Rows of three numbers. Throws: usage, naming the argument, for another shape or type.
std::vector<WorldPoint> points_of(const char* argument, const AnyArray& array);

/// Rows of three indices, each below `vertices`. Throws: as points_of; unreadable_input for an index out of range.
std::vector<std::array<uint32_t, 3>> triangles_of(const char* argument, const AnyArray& array, size_t vertices);

/// One row of whole numbers from 0 on, such as corners of polygons. Throws: as triangles_of.
std::vector<uint32_t> indices_of(const char* argument, const AnyArray& array, size_t end);

/// Three axes of whole numbers, the first one fastest. Throws: usage for another shape or type, and, naming its value
/// and place, for one that 32 bits do not hold.
std::vector<int32_t> labels_of(const char* argument, const AnyArray& array);

/// Throws: usage for what is no array of `dimensions` of single precision in the host's memory.
const float* floats_of(const char* argument, const AnyArray& array, size_t dimensions);

/// Owns a value for the arrays that show its memory.
template <class T>
nanobind::capsule owner_of(std::unique_ptr<T> value) {
  const nanobind::capsule owner(value.get(), [](void* p) noexcept { delete static_cast<T*>(p); });
  static_cast<void>(value.release());
  return owner;
}

/// Rows of three over the memory of `owner`, read-only.
template <class T>
using Rows = nanobind::ndarray<nanobind::numpy, const T, nanobind::shape<-1, 3>, nanobind::c_contig>;

Rows<double> rows_of(const std::vector<WorldPoint>& points, nanobind::handle owner);
/// Indices of a mesh stay below 2^31: as signed numbers, which users of numpy expect, they are the same bits.
Rows<int32_t> rows_of(const std::vector<std::array<uint32_t, 3>>& triangles, nanobind::handle owner);

}  // namespace isoshell::python
