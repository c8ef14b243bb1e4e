// How much memory the reading of an input may take.
#include "io/bytes/reading_budget.h"

#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell {

void ReadingBudget::take(int64_t bytes, const std::string& input) {
  const int64_t held_bytes = held_bytes_ += bytes;
  if (limit_bytes_ <= 0 || held_bytes <= limit_bytes_) return;
  give_back(bytes);
  throw Error(ErrorCode::out_of_memory, "read",
              input + ": needs at least " + readable_bytes(held_bytes) + " to be read, more than the limit of " +
                  readable_bytes(limit_bytes_) + "; raise --max-memory, or split the file");
}

}  // namespace isoshell
