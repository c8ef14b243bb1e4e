// Answers to signals: the run is asked to stop, and stopped where it does not hear in time.
#include "vdb_isomesh/interrupt.h"

#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <initializer_list>
#include <string>

#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell::tool {
namespace {

constexpr suseconds_t kPatienceUs = 250000, kAgainUs = 20000;
constexpr int kEnding = -1;

// What handlers read has no destructor: signals may come until the process has ended.
std::atomic<Context*> cancelled_by_signal{nullptr};
std::atomic<int> writing{0};  ///< so many files; kEnding: none will be any more
char speaker[256], written[1 << 15] = "nothing was written";
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<Context*>::is_always_lock_free,
              "handlers of signals may use them");

void wake_in(suseconds_t us) {
  const int kept = errno;  // of whatever the signal came between
  const itimerval timer{{0, 0}, {0, us}};
  setitimer(ITIMER_REAL, &timer, nullptr);
  errno = kept;
}

extern "C" void end_unless_writing(int) {
  int none = 0;
  if (!writing.compare_exchange_strong(none, kEnding)) return wake_in(kAgainUs);
  for (const char* text : std::initializer_list<const char*>{speaker, ": error: interrupted; ", written, "\n"})
    if (write(STDERR_FILENO, text, std::strlen(text)) < 0) break;  // nobody to tell
  _exit(int(ErrorCode::interrupted));
}

extern "C" void cancel_run(int number) {
  if (cancelled_by_signal.load()->cancel.exchange(true)) return end_unless_writing(number);
  wake_in(kPatienceUs);
}

template <size_t Size>
void put(const std::string& text, char (&into)[Size]) {
  into[text.copy(into, Size - 1)] = '\0';
}

}  // namespace

void answer_signals(Context& context, const std::string& program) {
  put(program, speaker);
  cancelled_by_signal = &context;
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a write that fails, not a silent end
  std::signal(SIGXFSZ, SIG_IGN);  // and so is one beyond a limit of file sizes
  std::signal(SIGALRM, end_unless_writing);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, cancel_run);
}

WhileWriting::WhileWriting() {
  int files = writing;
  while (files == kEnding || !writing.compare_exchange_weak(files, files + 1))
    if (files == kEnding) pause();  // for the end
}
WhileWriting::~WhileWriting() { --writing; }

void note_written(const std::string& path) {  // no handler reads it meanwhile, as a file is being written
  static std::string first;
  static int64_t count = 0;
  if (count++ == 0) first = path;
  put("written before: " + (count == 1 ? first : first + " to " + path + ", " + counted(count, "file")), written);
}

}  // namespace isoshell::tool
