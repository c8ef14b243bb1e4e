// Compiled once for every source of the library (CMake's target_precompile_headers): the standard library only, which
// nearly all use. (JSON in here would cost every source .35 s, TBB as much as it gains.) Sources still include what
// they use: ISOSHELL_PRECOMPILE=OFF, as in the presets strict and cpu-asan, compiles each alone.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>
