#include "victorious/recognizer.h"

#include <optional>
#include <utility>

#include "victorious/apps/library/facade.h"
#include "victorious/input/image/impulse_noise.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/model_engine.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/recognize/recognizer.h"

namespace libvictorious {

struct Recognizer::Impl {
  std::unique_ptr<const victorious::FeatureExtractor> extractor;
  double impulse_fraction = 0;
  victorious::Recognizer recognizer;
};

Recognizer::Recognizer(const std::vector<Model>& models, const RecognizerSettings& settings) {
  Guard([&] {
    if (models.empty()) throw Error(ErrorCode::kInvalidArgument, "no model to search for: give one or more");
    victorious::IndexOptions options;
    Unwrap(ApplyParams(settings.params, options));
    Unwrap(victorious::ValidateOptions(options));
    std::vector<victorious::ObjectModel> inner = ObjectModelsOf(models);
    Unwrap(victorious::AdoptEngineOfModels(inner, options.features, {}));
    auto extractor = Unwrap(victorious::MakeFeatureExtractor(options.features));
    impl_ = std::make_unique<Impl>(Impl{.extractor = std::move(extractor),
                                        .impulse_fraction = options.features.impulse_fraction,
                                        .recognizer = Unwrap(victorious::Recognizer::Create(
                                            std::move(inner), options.features.engine, options.recognize))});
  });
}

Recognizer::Recognizer(Recognizer&& other) noexcept = default;
Recognizer& Recognizer::operator=(Recognizer&& other) noexcept = default;
Recognizer::~Recognizer() = default;

std::vector<Detection> Recognizer::Recognize(const ImageView& image) const {
  return Guard([&] {
    const cv::Mat grey = Unwrap(GreyOf(image));
    const victorious::FeatureSet scene = Unwrap(impl_->extractor->Extract(grey));
    const cv::Mat clean = victorious::RemoveImpulses(grey, impl_->impulse_fraction);
    std::vector<Detection> detections;
    for (const victorious::Detection& one : Unwrap(impl_->recognizer.Recognize(scene, {}, clean))) {
      detections.push_back({.model = one.model_index,
                            .name = impl_->recognizer.models()[one.model_index].name,
                            .score = one.score,
                            .neg_log10_nfa = one.neg_log10_nfa,
                            .matches = one.fit.inliers.size(),
                            .view = one.view,
                            .box = BoxOf(one.box),
                            .outline = PointsOf(one.outline)});
    }
    return detections;
  });
}

}  // namespace libvictorious
