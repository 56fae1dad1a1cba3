// victorious bench ...: starts the benchmarks, a program of their own
#include "victorious/cli/command.h"
#include "victorious/cli/run_program.h"

namespace victorious::cli {

Action SetUpBench(CLI::App& app) { return SetUpSiblingProgram(app, "victorious-bench"); }

}  // namespace victorious::cli
