// What is written down of a run from wherever it is: how long stages take, what it warns of, what its products are, how
// much memory it takes. Who waits hears of each stage.
#pragma once

#include <chrono>
#include <type_traits>
#include <utility>

#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "isoshell/remesh_report.h"

namespace isoshell {

/// The log of a call. It stays where what was tried is given up; facts are returned, and go with it. Written to by the
/// thread of the call alone: the search for creases, which goes on on another, has none.
struct Run {
  Context& context;
  const bool want_digests = false;
  std::vector<StageTime> times = {};
  std::map<std::string, std::string> digests = {};
  std::vector<std::string> warnings = {};
  int64_t memory_estimate_bytes = 0;  ///< of the largest that was tried

  /// With that of a report: at the end of a call, and where another goes on from there.
  void exchange_log(RemeshReport& report) {
    times.swap(report.times);
    digests.swap(report.digests);
    warnings.swap(report.warnings);
    std::swap(memory_estimate_bytes, report.grid.memory_estimate_bytes);
  }

  void warn(std::string text) { warnings.push_back(std::move(text)); }

  void book_time(const std::string& stage, double ms) {
    for (StageTime& t : times)
      if (t.stage == stage) {
        t.ms += ms;
        return;
      }
    times.push_back({stage, ms});
  }

  /// Runs one stage, with all that it leaves to a device, books its time under its name, and tells its begin and its
  /// end, though it fails: there may be another way.
  template <class Work>
  auto timed(const char* stage, Work work) {
    using Clock = std::chrono::steady_clock;
    struct Book {
      Run& run;
      const char* stage;
      Clock::time_point start = Clock::now();
      ~Book() { run.book_time(stage, std::chrono::duration<double, std::milli>(Clock::now() - start).count()); }
    } book{*this, stage};
    const auto tell = [&](double fraction) {
      if (context.progress) context.progress(stage, fraction);
    };
    tell(0);
    try {
      if constexpr (std::is_void_v<decltype(work())>) {
        work();
        finish_stages(context);
        tell(1);
      } else {
        auto product = work();
        finish_stages(context);
        tell(1);
        return product;
      }
    } catch (const Error&) {
      tell(1);
      throw;
    }
  }

  template <class Product>
  void note_digest(const char* name, const Product& product) {
    if (want_digests) timed("digests", [&] { digests[name] = digest_text(digest(product)); });
  }
};

}  // namespace isoshell
