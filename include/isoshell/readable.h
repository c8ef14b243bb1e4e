// Numbers as people read them.
#pragma once

#include <cstdint>
#include <string>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// 1234567 as "1,234,567".
std::string with_commas(int64_t count);
/// "1 face", "3 faces"; `plural` where an s will not do.
std::string counted(int64_t count, const std::string& noun, const std::string& plural = "");
/// A place as "441906.25 6329780.5 12", each with six digits, and as many more as it takes to tell
/// places apart that are a hundred-thousandth of `size_world` from each other.
std::string readable_place(const WorldPoint& at, double size_world);
/// In a surface of that box, or on that lattice.
std::string readable_place(const WorldPoint& at, const WorldBox& box);
std::string readable_place(const WorldPoint& at, const LatticeFrame& frame);
/// The same with as many digits as all bits need.
std::string exact_place(const WorldPoint& at);
/// A length in world units, whatever these are, as "0.0123" or "193": to three digits.
std::string readable_length(double length_world);
/// Bytes as "1.5 GiB".
std::string readable_bytes(int64_t bytes);

}  // namespace isoshell
