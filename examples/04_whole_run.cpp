// The run that the command makes, as one call: any input that it reads, options as JSON, gates, statistics.
#include <iostream>

#include "isoshell/isoshell.h"

using namespace isoshell;

int main(int argc, char* argv[]) {
  if (argc < 3) return 2;
  try {
    Context context;
    RunRequest request;
    request.input = named_input(argv[1]);
    request.options = parse_options_json(R"({"vertices": 1500, "fit": "surface"})");
    request.output = named_output(argv[2] + std::string(".ply"), "", StopAfter::mesh);
    request.overwrite = true;
    request.gates = parse_gates("closed,manifold");
    request.measures = Measures::all;
    request.tell = [](MessageKind kind, const std::string& text) {
      if (kind == MessageKind::warning) std::cerr << "warning: " << text << "\n";
    };
    const RunResult result = run(request, context);
    std::cout << statistics_json(result.record);
    for (const std::string& text : result.missed_gates) std::cerr << "gate failed: " << text << "\n";
    return result.missed_gates.empty() ? 0 : int(ErrorCode::gate_failed);
  } catch (const Error& e) {
    std::cerr << e.stage() << ": " << e.what() << "\n";
    return int(e.code());
  }
}
