#include "vdb_isomesh/streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "isoshell/error.h"

namespace isoshell::tool {

void fill_closed_streams() {
  // The other way round than they are used: what is written to a closed standard output must fail.
  constexpr int kModes[] = {O_WRONLY, O_RDONLY, O_RDONLY};
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF) (void)!open("/dev/null", kModes[stream]);  // the lowest is free
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw Error(ErrorCode::unwritable_output, "write", std::string("standard output: ") + std::strerror(errno));
}

}  // namespace isoshell::tool
