// The views of one object as growth knows them: the photos of its model and what was learnt since. Finds them in a
// region, and learns another one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// A view that was learnt from a frame.
struct LearntView {
  std::int64_t frame = 0;
  Box box;                            ///< of the object in the frame, px
  Polygon outline;                    ///< px, likewise: what lies outside is not part of the view
  std::optional<std::size_t> parent;  ///< index of the older learnt view; std::nullopt: a photo
  double probability = 0;             ///< that it shows the object that the photo shows
};

class ViewChain {
 public:
  struct Found {
    int matches = 0;
    std::optional<std::size_t> view;  ///< learnt; std::nullopt: a photo
    double score = 0;
  };

  /// @param model      of photos; it and the options outlive the chain
  ViewChain(const ObjectModel& model, const RecognizeOptions& options) : model_(&model), options_(&options) {}

  /// The best view of the chain in features of a region, if its box agrees with `box`. Errors: as Recognizer::Create.
  [[nodiscard]] Expected<std::optional<Found>> Find(const FeatureSet& region, const Box& box);

  /// The score with which a view is found where an older one was recognised; 0: it is not.
  /// @param witness  features of a region in which a view of the chain was recognised, in `witness_box`
  /// @param region   features of the region around the view
  /// Errors: as Recognizer::Create.
  [[nodiscard]] Expected<double> ScoreIn(const FeatureSet& witness, const Box& witness_box, const LearntView& view,
                                         const FeatureSet& region) const;

  /// Learns a view, unless its probability or number of features is too low, or there are too many views. Returns
  /// whether it has.
  bool Learn(const LearntView& view, const FeatureSet& region);

  /// Forgets what was learnt after the first `count` views.
  void Forget(std::size_t count);

  /// Frees what searches need; the next one makes it anew.
  void Rest() { recognizer_.reset(); }

  [[nodiscard]] const std::vector<LearntView>& views() const { return views_; }

 private:
  [[nodiscard]] Status Prepare();

  const ObjectModel* model_;
  const RecognizeOptions* options_;
  std::vector<LearntView> views_;
  std::vector<FeatureSet> features_;  // of the views
  std::size_t first_ = 0;             // of the learnt views that are searched for
  std::optional<Recognizer> recognizer_;
};

}  // namespace victorious
