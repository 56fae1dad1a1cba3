// One template against one picture, with the truth of each match: what the tables and figures of chapter 3 are made of.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/evaluate/experiments/experiment.h"
#include "victorious/evaluate/experiments/known_scene.h"
#include "victorious/evaluate/experiments/true_matches.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/model/cad_model.h"
#include "victorious/recognize/recognizer.h"

namespace victorious {

/// How keypoints are found and matches filtered.
struct MatchSetup {
  std::string name;  ///< "thesis", "ours"
  FeatureOptions features;
  CadModelOptions cad;
  RecognizeOptions recognize;
};

/// The preset `thesis`: Lowe's keypoints, table 3.1.
MatchSetup ThesisSetup();
/// The program's defaults, by the grammar.
MatchSetup OurSetup();

/// The CAD file's model, named as the file is without its ending. Made once: kept in OUT/models, in a folder whose name
/// is by the file's content, the options and the program's version.
Expected<std::shared_ptr<const ObjectModel>> KeptModel(const ExperimentSettings& settings,
                                                       const std::filesystem::path& cad_file,
                                                       const CadModelOptions& options);

/// The view that looks at the object from nearest to a direction.
[[nodiscard]] std::size_t NearestView(const ObjectModel& model, const ViewDirection& direction);

/// Immutable once made; copies share what is large.
struct MatchTrial {
  std::string name;  ///< "jeep in circle_noise, frame 40"
  std::shared_ptr<const KnownScene> scene;
  std::shared_ptr<const FeatureSet> features;  ///< of the scene
  std::shared_ptr<const ObjectModel> model;
  std::size_t view = 0;
  MatchTruth truth;
  int flight = 0;  ///< of a pool's trial: PooledScene's

  [[nodiscard]] FeatureView Template() const { return model->ViewFeatures(view); }
  [[nodiscard]] MatchSet Matches(double ratio) const;
  [[nodiscard]] MatchCount Count(const MatchSet& matches) const { return truth.Count(features->keypoints, matches); }
  /// The best pose's inliers; none where there is no pose.
  [[nodiscard]] MatchSet Mlesac(const MatchSet& matches, const PoseOptions& options) const;
};

/// @param features  of the scene, by the model's setup
MatchTrial MakeTrial(std::shared_ptr<const KnownScene> scene, std::shared_ptr<const FeatureSet> features,
                     std::shared_ptr<const ObjectModel> model, std::size_t view);

/// What each stage leaves of a trial's matches.
struct StageMatches {
  static constexpr std::array kNames = {"none", "first", "second", "third", "MLESAC"};
  std::array<MatchSet, 5> sets;
};
StageMatches RunStages(const MatchTrial& trial, double ratio, const RecognizeOptions& options);

/// The picture's features by a setup.
Expected<std::shared_ptr<const FeatureSet>> FeaturesOf(const KnownScene& scene, const FeatureOptions& options);

/// The two running examples of section 3.5: scenes/chapter3_jeep.json for the Humvee, chapter3_jet.json for the MiG,
/// each with the template of the view nearest to the true one.
Expected<MatchTrial> RunningExample(const ExperimentSettings& settings, const MatchSetup& setup,
                                    const std::string& kind);

}  // namespace victorious
