// Rewrites the golden file: update_golden > tests/golden/golden.txt
#include <cstdio>

#include "golden/golden_cases.h"

int main() {
  isoshell::Context context;
  for (const isoshell::golden::Case& c : isoshell::golden::cases())
    std::fputs(isoshell::golden::run(c, context).c_str(), stdout);
  for (const isoshell::golden::RunCase& c : isoshell::golden::run_cases())
    std::fputs(isoshell::golden::run(c, context).c_str(), stdout);
}
