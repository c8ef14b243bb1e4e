// Entry of libFuzzer; ISOSHELL_FUZZ_TARGET names the reader.
#include <tbb/global_control.h>

#include <cstdint>
#include <cstring>

#include "fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  static const isoshell::fuzz::Target* const target = [] {
    for (const isoshell::fuzz::Target& t : isoshell::fuzz::targets())
      if (!std::strcmp(t.name, ISOSHELL_FUZZ_TARGET)) return &t;
    return static_cast<const isoshell::fuzz::Target*>(nullptr);
  }();
  isoshell::fuzz::run_or_abort(*target, {reinterpret_cast<const char*>(data), int64_t(size)});
  return 0;
}
