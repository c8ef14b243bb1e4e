// A run step by step, for who keeps, looks at or writes what is between the steps. run() is all of them in their order.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "isoshell/run/run.h"

namespace isoshell {

/// One run. Each step first does those before it that are not done yet, and is done once. After a step that throws,
/// other than one that saves, the run cannot go on; an interruption says which files were written before. Contexts may
/// differ from step to step, but not in their backend and device.
class RunSteps {
 public:
  /// Throws: as check_request() does.
  explicit RunSteps(RunRequest request);
  RunSteps(RunSteps&&) noexcept;
  RunSteps& operator=(RunSteps&&) noexcept;
  ~RunSteps();

  /// Checks that every file can be written, and reads the input, or takes what another way of reading gives.
  void read(Context& context, const std::function<Input()>& another_way = {});
  /// The same with an input that was read already, or came from memory; prepare() then checks the files.
  void take(Input input, Context& context);
  const Input& input() const;  ///< once it is there; when prepared without triangles, unless attributes are on them

  /// What the run would take, from its input alone. Throws: usage for a stage file.
  RunEstimate estimate(Context& context);
  const Prepared& prepare(Context& context);
  const Relaxed& relax(Context& context);
  /// Stage files beside those of the request. Throws: usage unless want_shell asked for the shell, and for the seeds of
  /// patches, which a Voronoi stage file does not hold; as writing does.
  void save_shell(const std::string& path, bool overwrite, Context& context);
  void save_voronoi(const std::string& path, bool overwrite, Context& context);
  /// All that is left: the mesh, its measures, its files and the gates. The run is over then: only with `keeps_seeds`
  /// those of relax() are there still.
  RunResult finish(Context& context, bool keeps_seeds = false);

  /// Who is told from now on, called around each writing of a file, and waits: as in a request.
  void report_to(Tell tell, AroundWrite around_write, TellProgress progress);

 private:
  class Run;
  std::unique_ptr<Run> run_;
};

}  // namespace isoshell
