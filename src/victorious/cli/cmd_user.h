// The command `victorious user`.
#pragma once

#include "victorious/cli/command.h"

namespace victorious::cli {

Action SetUpUser(CLI::App& app);

}  // namespace victorious::cli
