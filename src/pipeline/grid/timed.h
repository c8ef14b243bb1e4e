// How long stages take, and what their products are, into the report of a run; who waits hears of each.
#pragma once

#include <chrono>
#include <type_traits>

#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "isoshell/remesh.h"

namespace isoshell {

inline void book_time(RemeshReport& report, const char* stage, double ms) {
  for (StageTime& t : report.times)
    if (t.stage == stage) {
      t.ms += ms;
      return;
    }
  report.times.push_back({stage, ms});
}

/// Runs one stage, with all that it leaves to a device, books its time under its name, and tells its begin and its end,
/// though it fails: there may be another way.
template <class Work>
auto timed(RemeshReport& report, const char* stage, Context& context, Work work) {
  using Clock = std::chrono::steady_clock;
  struct Book {
    RemeshReport& report;
    const char* stage;
    Clock::time_point start = Clock::now();
    ~Book() { book_time(report, stage, std::chrono::duration<double, std::milli>(Clock::now() - start).count()); }
  } book{report, stage};
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
void note_digest(const RemeshOptions& options, RemeshReport& report, Context& context, const char* name,
                 const Product& product) {
  if (!options.want_digests) return;
  timed(report, "digests", context, [&] { report.digests[name] = digest_text(digest(product)); });
}

}  // namespace isoshell
