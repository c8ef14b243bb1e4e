// Numbers as people read them.
#pragma once

#include <cstdint>
#include <string>

namespace isoshell {

/// 1234567 as "1,234,567".
std::string with_commas(int64_t count);
/// "1 face", "3 faces"; `plural` where an s will not do.
std::string counted(int64_t count, const std::string& noun, const std::string& plural = "");
/// Bytes as "1.5 GiB".
std::string readable_bytes(int64_t bytes);

}  // namespace isoshell
