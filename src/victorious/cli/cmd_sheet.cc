// victorious sheet --db FILE --out PNG: the finds as pictures
#include <memory>

#include <fmt/format.h>

#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/pipeline/contact_sheet.h"
#include "victorious/video/image_file.h"

namespace victorious::cli {

Action SetUpSheet(CLI::App& app) {
  struct Arguments {
    std::string db;
    std::string out;
    ContactSheetOptions options;
    FilterArguments filter;
  };
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("--db", arguments->db, "The index; its videos must still be where they were")
      ->required()
      ->type_name("FILE");
  app.add_option("--out", arguments->out, "The picture (.png, .jpg)")->required()->type_name("FILE");
  app.add_option("--most", arguments->options.most_tiles, "Objects shown, best first")->type_name("N");
  app.add_option("--columns", arguments->options.columns, "Pictures in a row")->type_name("N");
  arguments->filter.AddTo(app);
  return [=]() -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(const SightingFilter filter, arguments->filter.Filter());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store,
                                OpenSqliteStore(arguments->db, StoreMode::kRead));
    VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat sheet, DrawContactSheet(filter, arguments->options, *store));
    return WriteImage(arguments->out, sheet);
  };
}

}  // namespace victorious::cli
