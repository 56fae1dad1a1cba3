// Private to cmd_category*.cc: the parts of `victorious category` that have a file of their own.
#pragma once

#include "victorious/apps/cli/argument_parser.h"
#include "victorious/apps/cli/command.h"

namespace victorious::cli {

/// `category import`: a detection network as a source of categories.
Action SetUpCategoryImport(ArgumentParser& parser);
/// `category show`: one model or detector in detail.
Action SetUpCategoryShow(ArgumentParser& parser);
/// `category list`: one row for each model and detector in a folder.
Action SetUpCategoryList(ArgumentParser& parser);

}  // namespace victorious::cli
