// Of library/ alone: how its sources pass from values with errors to the exception of the public headers, and from
// image views to cv::Mat.
#pragma once

#include <exception>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/one_line.h"
#include "victorious/base/options.h"
#include "victorious/base/progress.h"
#include "victorious/error.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/image.h"
#include "victorious/jobs/preset.h"
#include "victorious/model.h"
#include "victorious/progress.h"
#include "victorious/types/object_model.h"

namespace libvictorious {

struct Model::Impl {
  victorious::ObjectModel model;
};

[[noreturn]] void Raise(const victorious::Error& error);

template <typename T>
T Unwrap(victorious::Expected<T> result) {
  if (!result) Raise(result.error());
  return *std::move(result);
}
inline void Unwrap(const victorious::Status& status) {
  if (!status) Raise(status.error());
}

/// Calls `work`. What it throws of other libraries becomes an Error.
template <typename Work>
auto Guard(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& thrown) {
    Raise({.code = victorious::ErrorCode::kInternal, .message = victorious::OneLine(thrown.what())});
  }
}

/// Calls what a caller gave, from within work that no exception may leave.
class CallerCode {
 public:
  /// Returns what `call` returns; false if it throws, or if an earlier call did.
  template <typename Call>
  bool Run(const Call& call) {
    if (thrown_) return false;
    try {
      return call();
    } catch (...) {
      thrown_ = std::current_exception();
      return false;
    }
  }
  /// Throws what was thrown.
  void Rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  std::exception_ptr thrown_;
};

/// Long work: what it reports goes to the callback, which may end it.
class LongWork {
 public:
  /// @param progress  outlives the work; may be empty
  explicit LongWork(const ProgressCallback& progress);

  [[nodiscard]] const victorious::CancelToken& cancel() const { return cancel_; }

  /// The value of the work. Throws what the callback threw, or the error. Called outside of Guard(), which would take
  /// what the callback threw for an error of the library.
  template <typename T>
  T Finish(victorious::Expected<T> result) const {
    caller_.Rethrow();
    return Unwrap(std::move(result));
  }

 private:
  void Report(const victorious::ProgressEvent& event);

  const ProgressCallback& progress_;
  CallerCode caller_;
  victorious::CancelToken cancel_;
  victorious::ProgressCapture capture_;
};

/// Sets options from a JSON object or the name of a preset; empty changes nothing. Error: kInvalidArgument.
template <typename Options>
[[nodiscard]] victorious::Status ApplyParams(const std::string& params, Options& options) {
  if (params.empty()) return {};
  if (const auto preset = victorious::FromText(victorious::kPresetTexts, params)) {
    return victorious::ApplyPreset(*preset, options);
  }
  victorious::Status set = victorious::SetFromJsonText(params, victorious::CollectFields(options));
  if (!set) return std::unexpected(std::move(set).error().WithContext("params"));
  return set;
}

/// Copies of the models, which share their features.
[[nodiscard]] std::vector<victorious::ObjectModel> ObjectModelsOf(const std::vector<Model>& models);

/// The pixels of a view, not copied: valid as long as they are. Error: kInvalidArgument if it describes no image.
[[nodiscard]] victorious::Expected<cv::Mat> MatOf(const ImageView& view);

/// CV_8UC3; of a view of kBgr not copied. Errors: as MatOf.
[[nodiscard]] victorious::Expected<cv::Mat> BgrOf(const ImageView& view);

/// CV_8UC1; of a view of kGrey not copied. Errors: as MatOf.
[[nodiscard]] victorious::Expected<cv::Mat> GreyOf(const ImageView& view);

/// @param mat  CV_8UC1, or CV_8UC3 in the order of BGR
[[nodiscard]] ImageView ViewOf(const cv::Mat& mat);

[[nodiscard]] inline Box BoxOf(const victorious::Box& box) { return {box.x, box.y, box.width, box.height}; }
[[nodiscard]] std::vector<Point> PointsOf(const victorious::Polygon& polygon);

}  // namespace libvictorious
