// victorious experiment ...: starts the experiments, a program of their own
#include "victorious/cli/command.h"
#include "victorious/cli/run_program.h"

namespace victorious::cli {

Action SetUpExperiment(CLI::App& app) { return SetUpSiblingProgram(app, "victorious-experiment"); }

}  // namespace victorious::cli
