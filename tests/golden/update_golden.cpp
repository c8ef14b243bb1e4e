// Rewrites the golden file: update_golden > tests/golden/golden.txt
#include <cstdio>

#include "golden/golden_cases.h"

int main() {
  isoshell::Context context;
  std::fputs(isoshell::golden::all(context).c_str(), stdout);
}
