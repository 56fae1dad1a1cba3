// What the export formats share: names by id, and numbers with as many decimals as they are worth.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// Keeps the order in which keys are added.
using Json = nlohmann::ordered_json;

/// The videos and models of a store that a filter lets through, checked to be there.
class Catalogue {
 public:
  static Expected<Catalogue> Read(IndexStore& store, const SightingFilter& filter);

  [[nodiscard]] const std::vector<VideoRecord>& videos() const { return videos_; }
  [[nodiscard]] const std::vector<ModelRecord>& models() const { return models_; }
  /// `id` must be of a row that the same filter let through; one added meanwhile by another process has no name yet.
  [[nodiscard]] const VideoRecord* Video(std::int64_t id) const;
  [[nodiscard]] const ModelRecord* Model(std::int64_t id) const;

 private:
  std::vector<VideoRecord> videos_;
  std::vector<ModelRecord> models_;
};

Json TimeJson(double time_s);
Json ScoreJson(double score);
Json DegreesJson(double angle_rad);
/// [x, y, w, h]
Json BoxJson(const Box& box);
/// [[x, y], …]
Json OutlineJson(const Polygon& outline);
/// px to two decimals
double RoundPixels(double value_px);

/// On one line; bytes that are not UTF-8 become U+FFFD.
std::string Dump(const Json& json);

}  // namespace victorious
