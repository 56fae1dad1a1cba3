// For tests only: surface samples of a flat object, in place of a CAD model's.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "victorious/object/features/relit_templates.h"

namespace victorious::testing {

/// The appearance of a flat image seen from the nadir, one pixel a metre: every view has it, and no view has a relit
/// template.
class FlatViewSource : public RelitTemplateSource {
 public:
  /// @param grey  CV_8UC1; sampled every `spacing_px` along both axes, from the middle of the pixel `first_px`
  FlatViewSource(const cv::Mat& grey, int first_px, int spacing_px) {
    auto appearance = std::make_shared<ViewAppearance>();
    appearance->centre_px = {grey.cols / 2.0, grey.rows / 2.0};
    for (int row = first_px; row < grey.rows; row += spacing_px) {
      for (int column = first_px; column < grey.cols; column += spacing_px) {
        const Eigen::Vector2d at = Eigen::Vector2d(column + 0.5, row + 0.5) - appearance->centre_px;
        appearance->points.push_back(
            {Eigen::Vector3d(at.x(), at.y(), 0).cast<float>(), static_cast<float>(grey.at<std::uint8_t>(row, column))});
      }
    }
    appearance_ = std::move(appearance);
  }

  [[nodiscard]] Expected<std::shared_ptr<const RelitTemplate>> GetTemplate(
      const RelitTemplateKey& /*wanted*/) const override {
    return std::make_shared<const RelitTemplate>();
  }
  void Prepare(std::span<const RelitTemplateKey> /*wanted*/) const override {}
  [[nodiscard]] Expected<std::shared_ptr<const ViewAppearance>> GetAppearance(std::size_t /*view*/,
                                                                              int /*half_octaves*/) const override {
    return appearance_;
  }
  [[nodiscard]] Expected<RenderedSurface> GetSurface(std::size_t /*view*/) const override { return RenderedSurface{}; }

 private:
  std::shared_ptr<const ViewAppearance> appearance_;
};

}  // namespace victorious::testing
