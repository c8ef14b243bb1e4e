// Answers to signals: the run is asked to stop, and stopped where it does not hear in time.
#include "vdb_isomesh/interrupt.h"

#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <string>

#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell::tool {
namespace {

constexpr suseconds_t kPatienceUs = 250000, kAgainUs = 20000;

std::atomic<Context*> cancelled_by_signal{nullptr};
std::atomic<const char*> speaker{""};
std::atomic<const char*> written{"nothing was written"};
std::atomic<int> writing{0};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<Context*>::is_always_lock_free,
              "handlers of signals may use them");

void wake_in(suseconds_t us) {
  const itimerval timer{{0, 0}, {0, us}};
  setitimer(ITIMER_REAL, &timer, nullptr);
}

extern "C" void end_unless_writing(int) {
  if (writing > 0) return wake_in(kAgainUs);
  for (const char* text : {speaker.load(), ": error: interrupted; ", written.load(), "\n"})
    if (write(STDERR_FILENO, text, std::strlen(text)) < 0) break;  // nobody to tell
  _exit(int(ErrorCode::interrupted));
}

extern "C" void cancel_run(int number) {
  if (cancelled_by_signal.load()->cancel.exchange(true)) return end_unless_writing(number);
  wake_in(kPatienceUs);
}

}  // namespace

void answer_signals(Context& context, const char* program) {
  speaker = program;
  cancelled_by_signal = &context;
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a write that fails, not a silent end
  std::signal(SIGXFSZ, SIG_IGN);  // and so is one beyond a limit of file sizes
  std::signal(SIGALRM, end_unless_writing);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, cancel_run);
}

WhileWriting::WhileWriting() { ++writing; }
WhileWriting::~WhileWriting() { --writing; }

void note_written(const std::string& path) {
  static std::string first, texts[2];  // no handler looks at them meanwhile: it waits for what is being written
  static int64_t count = 0;
  if (count++ == 0) first = path;
  std::string& text = texts[count % 2];
  text = "written before: " + (count == 1 ? first : first + " to " + path + ", " + counted(count, "file"));
  written = text.c_str();
}

}  // namespace isoshell::tool
