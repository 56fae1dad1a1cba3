// The command `victorious copy`.
#pragma once

#include "victorious/cli/command.h"

namespace victorious::cli {

Action SetUpCopy(CLI::App& app);

}  // namespace victorious::cli
