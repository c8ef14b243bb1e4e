// Last words of a process that a signal ends.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "support/catch.h"
#include "vdb_isomesh/interrupt.h"

using namespace isoshell;

namespace {

struct Ended {
  int status = 0;
  std::string said;
};

/// A process of its own, for which `work` answers signals.
Ended process_of(const std::function<void()>& work) {
  std::fflush(nullptr);
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDERR_FILENO);
    work();
    std::exit(0);
  }
  close(ends[1]);
  Ended ended;
  for (char c; read(ends[0], &c, 1) == 1;) ended.said += c;
  close(ends[0]);
  waitpid(child, &ended.status, 0);
  return ended;
}

Context context;

}  // namespace

TEST_CASE("interrupt: the last words are there until the process has ended", "[interrupt]") {
  const std::string path(100, 'p');
  const Ended late = process_of([&] {
    tool::answer_signals(context, "program");
    std::atexit([] { std::raise(SIGALRM); });  // after what is destroyed
    const tool::WhileWriting writing;
    for (int i = 0; i < 3; ++i) tool::note_written(path + std::to_string(i));
  });
  CHECK(late.said == "program: error: interrupted; written before: " + path + "0 to " + path + "2, 3 files\n");
  CHECK(WEXITSTATUS(late.status) == 130);
}

TEST_CASE("interrupt: the name of the program is a copy, and a path of any length is cut", "[interrupt]") {
  const Ended ended = process_of([] {
    std::string name = "program";
    tool::answer_signals(context, name);
    name = "another";
    {
      const tool::WhileWriting writing;
      tool::note_written(std::string(100000, 'p'));
      std::raise(SIGALRM);  // passes by
    }
    std::raise(SIGALRM);
  });
  CHECK(ended.said.substr(0, 53) == "program: error: interrupted; written before: pppppppp");
  CHECK(ended.said.size() < 33000);
  CHECK(WEXITSTATUS(ended.status) == 130);
}
