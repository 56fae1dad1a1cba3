// A match trial: one template against one image, with the truth of each match. The tables and figures of chapter 3 are
// computed from trials.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "experiments/experiment.h"
#include "experiments/known_scene.h"
#include "experiments/true_matches.h"
#include "victorious/base/error.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious {

/// The configuration of feature extraction, model building and match filtering.
struct MatchSetup {
  enum class Kind { kThesis, kDefault };

  Kind kind = Kind::kDefault;
  std::string name;  ///< in reports: "thesis", "ours"
  FeatureOptions features;
  CadModelOptions cad;
  RecognizeOptions recognize;
};

/// The preset `thesis`: Lowe's keypoints, table 3.1.
MatchSetup ThesisSetup();
/// The program's defaults, by the grammar.
MatchSetup DefaultSetup();

/// Returns the model of a CAD file, named after the file's stem. It is built once and cached in OUT/models, in a folder
/// keyed by the file's content, the options and the program build.
[[nodiscard]] Expected<std::shared_ptr<const ObjectModel>> LoadOrBuildModel(const ExperimentSettings& settings,
                                                                            const std::filesystem::path& cad_file,
                                                                            const CadModelOptions& options);

/// Immutable; copies share the large members.
struct MatchTrial {
  std::string name;  ///< "jeep in circle_noise, frame 40"
  std::shared_ptr<const AnnotatedImage> scene;
  std::shared_ptr<const FeatureSet> features;  ///< of the scene
  std::shared_ptr<const ObjectModel> model;
  std::size_t view = 0;
  MatchTruth truth;
  int flight = 0;  ///< PooledScene::flight, for a trial of a pool

  [[nodiscard]] FeatureView Template() const { return model->ViewFeatures(view); }
  /// The matches that pass the ratio test at `ratio`.
  [[nodiscard]] MatchSet Matches(double ratio) const;
  [[nodiscard]] MatchCount Count(const MatchSet& matches) const { return truth.Count(features->keypoints, matches); }
  /// The inliers of the best fit by MLESAC; empty if there is no fit.
  [[nodiscard]] MatchSet Mlesac(const MatchSet& matches, const PoseOptions& options) const;
};

/// @param features  of the scene, extracted with the options of the model
/// @param view      index of the template's view
MatchTrial MakeTrial(std::shared_ptr<const AnnotatedImage> scene, std::shared_ptr<const FeatureSet> features,
                     std::shared_ptr<const ObjectModel> model, std::size_t view);

/// The matches that each stage of the cascade keeps, then MLESAC.
struct StageMatches {
  static constexpr std::array kNames = {"none", "first", "second", "third", "MLESAC"};
  std::array<MatchSet, 5> sets;
};
StageMatches RunStages(const MatchTrial& trial, double ratio, const RecognizeOptions& options);

/// Extracts the features of an image.
[[nodiscard]] Expected<std::shared_ptr<const FeatureSet>> ExtractImageFeatures(const AnnotatedImage& scene,
                                                                               const FeatureOptions& options);

/// Returns a running example of section 3.5: scenes/chapter3_jeep.json in place of the Humvee, or chapter3_jet.json in
/// place of the MiG, with the template of the view nearest to the true one.
/// @param kind  "jeep" or "jet"
/// Error: kInvalidArgument if the scene does not show the object.
[[nodiscard]] Expected<MatchTrial> RunningExample(const ExperimentSettings& settings, const MatchSetup& setup,
                                                  const std::string& kind);

}  // namespace victorious
