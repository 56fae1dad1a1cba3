// Whether this machine can do what the program does: draws a short flight over a town, and finds an object in it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "victorious/apps/serve/api_options.h"
#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious::cli {

/// How one check ended.
struct SelfTestRow {
  std::string name;
  bool is_good = false;
  double seconds = 0;
  std::string text;  ///< what was found; of a failure, why
};

/// Runs all checks; `report` gets each row as it ends. What needs a check that failed is not tried: its row says so.
/// Cost: some 20 s of processor time.
/// @param folder  an empty one, for the flight and the index
/// Error: kCancelled.
[[nodiscard]] Expected<std::vector<SelfTestRow>> RunSelfTest(const SampleFiles& sample,
                                                             const std::filesystem::path& folder,
                                                             const CancelToken& cancel,
                                                             const std::function<void(const SelfTestRow&)>& report);

}  // namespace victorious::cli
