#include "isoshell/remesh_many.h"

#include <chrono>
#include <deque>
#include <new>
#include <utility>

#include "core/watched.h"
#include "isoshell/advanced/workers.h"

namespace isoshell {
namespace {

using namespace std::chrono_literals;
using UnderWay = std::future<RemeshResult>;

constexpr auto kLook = 20ms;  ///< how soon a cancelled context is noticed
constexpr int64_t kMostAWorker = 4;

bool has_ended(const UnderWay& run, std::chrono::milliseconds limit) {
  return run.wait_for(limit) == std::future_status::ready;
}

ManyResult result_of(int64_t index, UnderWay run) {
  ManyResult result;
  result.index = index;
  try {
    result.made = run.get();
  } catch (const Error& error) {
    result.error = error;
  } catch (const std::bad_alloc&) {
    result.error = Error(ErrorCode::out_of_memory, "memory", "out of memory; lower the resolution");
  } catch (const std::exception& error) {
    result.error = Error(ErrorCode::internal, "remesh", error.what());
  }
  return result;
}

}  // namespace

int64_t remesh_many(const ManyRequest& request, const RemeshOptions& options, Context& context) {
  Workers workers(context, request.workers);
  const int64_t most = request.most_under_way > 0 ? request.most_under_way : kMostAWorker * workers.count();
  std::deque<UnderWay> runs;
  int64_t handed_out = 0;
  for (bool has_more = true; has_more || !runs.empty();) {
    check_cancel(context, "remesh many");
    if (!runs.empty() && has_ended(runs.front(), 0ms)) {
      UnderWay run = std::move(runs.front());
      runs.pop_front();
      request.take(result_of(handed_out++, std::move(run)));
    } else if (has_more && int64_t(runs.size()) < most) {
      std::optional<TriangleSoup> soup = request.next();
      has_more = soup.has_value();
      if (soup)
        runs.push_back(
            workers.begin([soup = std::move(*soup), &options](Context& own) { return remesh(soup, options, own); }));
    } else if (!runs.empty()) {
      has_ended(runs.front(), kLook);
    }
  }
  return handed_out;
}

}  // namespace isoshell
