// The thresholds of models that a team has put into force: what nobody has decided and scores lower is left out.
// Input: thresholds (from serve/, score_threshold.h learns them). Output: the same; the decisions that they are learnt
// from. A threshold belongs to the name of a model, as reviews do, and outlives a new search.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/score_threshold.h"

namespace victorious {

struct ModelThreshold {
  std::string model;  ///< name
  double min_score = 0;
  std::string set_by;           ///< who put it into force; empty: nobody gave a name
  std::int64_t set_utc_us = 0;  ///< microseconds since 1970
};

/// What the team decided about the objects of a model.
struct ModelDecisions {
  std::int64_t model = 0;  ///< id
  std::vector<DecidedScore> decisions;
};

/// Not thread-safe: use from one thread at a time.
class ThresholdStore {
 public:
  virtual ~ThresholdStore() = default;

  /// Those in force, by name.
  [[nodiscard]] virtual Expected<std::vector<ModelThreshold>> Thresholds() = 0;
  /// Replaces the threshold of a model, and writes that to the log.
  [[nodiscard]] virtual Status Put(const ModelThreshold& threshold) = 0;
  /// Ends the threshold of a model, if there is one, and writes that to the log.
  [[nodiscard]] virtual Status Remove(const std::string& model, const std::string& actor, std::int64_t now_us) = 0;
  /// Of each model with a decision, by id. Cost: that of counting the objects.
  [[nodiscard]] virtual Expected<std::vector<ModelDecisions>> Decisions() = 0;
};

/// Opens the thresholds of an index, that OpenStore opens under this name. Errors: those of OpenStore.
[[nodiscard]] Expected<std::unique_ptr<ThresholdStore>> OpenThresholdStore(const std::string& name, StoreMode mode);

}  // namespace victorious
