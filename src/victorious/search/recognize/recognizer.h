// recognize/, the stages match, grammar, pose and detect as one call, shared by indexing, `match` and the search by
// image. In: a scene's features. Out: the detections of all models.
//
// Each model is searched by one method (model_searcher.h lists the methods and tells how to add one). Uncertain
// detections of models with stored renderings are then rescored by an NCC comparison with the image (ncc_rescoring.h).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/kernels/nearest_device.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/search/recognize/grammar_search.h"
#include "victorious/search/recognize/model_searcher.h"
#include "victorious/search/recognize/recognize_options.h"
#include "victorious/search/recognize/shortened_views.h"
#include "victorious/search/recognize/sun_estimate.h"
#include "victorious/search/recognize/view_part.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Errors: kInvalidArgument with the name of the first model whose features come from another engine.
[[nodiscard]] Status CheckEngine(std::span<const ObjectModel> models, std::string_view engine);

/// Finds the instances of models in scenes. Immutable and thread-safe.
class Recognizer {
 public:
  /// @param engine           feature engine of the scenes (CheckEngine)
  /// @param relit_templates  one source of relit templates per model, null for a model without; empty: none
  /// @param device           computes distances of descriptors; null: the processor. The results do not depend on it
  /// Errors: kInvalidArgument for options out of range or models of another engine.
  [[nodiscard]] static Expected<Recognizer> Create(
      std::vector<ObjectModel> models, const std::string& engine, const RecognizeOptions& options,
      const std::vector<std::shared_ptr<const RelitTemplateSource>>& relit_templates = {},
      std::shared_ptr<kernels::NearestDevice> device = {});
  /// The same of models that are shared instead of copied. @param models  not null
  [[nodiscard]] static Expected<Recognizer> Create(
      std::shared_ptr<const std::vector<ObjectModel>> models, const std::string& engine,
      const RecognizeOptions& options,
      const std::vector<std::shared_ptr<const RelitTemplateSource>>& relit_templates = {},
      std::shared_ptr<kernels::NearestDevice> device = {});

  [[nodiscard]] const std::vector<ObjectModel>& models() const { return *models_; }
  /// As given to Create().
  [[nodiscard]] std::span<const std::shared_ptr<const RelitTemplateSource>> relit_templates() const {
    return relit_templates_;
  }

  /// The detections of all models, by falling score. Deterministic.
  /// @param conditions  known priors: restrict models with known view angles to upright poses, and relight their
  ///                    templates for the sun
  /// @param grey        the scene's image, CV_8UC1, without impulse noise (RemoveImpulses), for the NCC rescoring of
  ///                    uncertain detections; empty: no rescoring
  /// @param part        of the views, for the frames of a video
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::vector<Detection>> Recognize(const FeatureSet& scene,
                                                           const FrameConditions& conditions = {},
                                                           const cv::Mat& grey = {}, const ViewPart& part = {}) const;

  /// The detections of some views of one model, for tracking: the object and its approximate aspect are known.
  /// @param scene  features of a region of interest, in the frame's pixels
  /// @param model  index into models()
  /// @param views  indices into the model's views
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::vector<Detection>> RecognizeViews(const FeatureSet& scene, std::size_t model,
                                                                std::span<const std::size_t> views,
                                                                const FrameConditions& conditions) const;

  /// True if EstimateSun() can succeed: at least one model has relit templates.
  [[nodiscard]] bool HasRelitTemplates() const;

  /// Estimates the sun's direction from the shading of an object in the scene (sun_estimate.h). std::nullopt in most
  /// scenes: no object is significant enough.
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::optional<SunEstimate>> EstimateSun(const FeatureSet& scene,
                                                                 const Vertical& vertical) const;

  /// The stages of the grammar for one view of one model, independent of the configured method.
  [[nodiscard]] StagedMatches MatchView(const FeatureSet& scene, std::size_t model, std::size_t view) const;

 private:
  Recognizer(std::shared_ptr<const std::vector<ObjectModel>> models, const RecognizeOptions& options,
             const std::vector<std::shared_ptr<const RelitTemplateSource>>& relit_templates,
             std::shared_ptr<kernels::NearestDevice> device);

  [[nodiscard]] Status RescoreByNcc(const cv::Mat& grey, std::vector<Detection>& detections) const;

  std::shared_ptr<const std::vector<ObjectModel>> models_;  // the searchers keep references to models
  std::vector<std::shared_ptr<const RelitTemplateSource>> relit_templates_;
  std::vector<std::shared_ptr<const ShortenedViews>> shortened_;  // one per model
  std::vector<std::shared_ptr<const ModelSearcher>> searchers_;   // one per model
  RecognizeOptions options_;
  std::shared_ptr<kernels::NearestDevice> device_;  // null: none
};

}  // namespace victorious
