// Objects in one image, without a video around it: no tracking, no telemetry, and the threshold of a single image.
//
//   Recognizer recognizer(ModelLibrary("models").LoadAll());
//   for (const Detection& one : recognizer.Recognize(Image::Read("photo.jpg").view())) Use(one);
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <victorious/export.h>
#include <victorious/image.h>
#include <victorious/model.h>

namespace libvictorious {

struct Detection {
  std::size_t model = 0;       ///< index into the models of the recogniser
  std::string name;            ///< of the model
  double score = 0;            ///< 0 to 1, higher is likelier
  double neg_log10_nfa = 0;    ///< -log10 of the number of false alarms, decades
  std::size_t matches = 0;     ///< keypoints that the fit explains
  std::size_t view = 0;        ///< index of the view of the model that matches best
  Box box;                     ///< of the outline, clipped to the image, px
  std::vector<Point> outline;  ///< px; may leave the image
};

struct RecognizerSettings {
  /// JSON object of parameters, or a preset's name; empty: the defaults. Names and ranges: `victorious params index`;
  /// what concerns the features of a frame and the search in it has an effect.
  std::string params;
};

/// Finds the instances of models in images. Never changes. Thread-safe.
class LIBVICTORIOUS_EXPORT Recognizer {
 public:
  /// Errors: kInvalidArgument for no models, models of different feature engines, or parameters out of range.
  explicit Recognizer(const std::vector<Model>& models, const RecognizerSettings& settings = {});
  Recognizer(Recognizer&& other) noexcept;
  Recognizer& operator=(Recognizer&& other) noexcept;
  ~Recognizer();

  /// The detections of all models, by falling score. The result does not depend on the number of threads. Runs on all
  /// processors; about 0.1 s a megapixel, and some ms a model.
  /// Error: kInvalidArgument for a view that describes no image.
  [[nodiscard]] std::vector<Detection> Recognize(const ImageView& image) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace libvictorious
