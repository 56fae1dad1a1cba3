#include "victorious/jobs/model_engine.h"

#include <algorithm>

#include <fmt/format.h>

namespace victorious {

Status AdoptEngineOfModels(std::span<const ObjectModel> models, FeatureOptions& features, const WarningSink& warn) {
  if (models.empty()) return {};
  const ObjectModel& first = models.front();
  const auto other =
      std::ranges::find_if(models, [&](const ObjectModel& model) { return model.engine != first.engine; });
  if (other != models.end()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("models of different feature engines: {} of {}, {} of {}: make those of one engine again, "
                            "by `victorious model add`",
                            first.name, first.engine, other->name, other->engine));
  }
  if (first.engine == features.engine) return {};
  if (warn) {
    warn(
        fmt::format("the models' features are of the engine {}: it makes the features of the video, too, not {}; to "
                    "change that, make the models again by `victorious model add`",
                    first.engine, features.engine));
  }
  features.engine = first.engine;
  return {};
}

}  // namespace victorious
