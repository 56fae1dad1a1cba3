// The centres of the cells of object/features/descriptor_cells.h: k-means of the shortened descriptors of the project's
// own CAD models. Writes descriptor_cells.inc, which is part of the source.
#include "victorious/object/features/descriptor_cells.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "experiments/match_trial.h"
#include "experiments/recognition_experiments.h"
#include "victorious/base/file.h"
#include "victorious/base/folder.h"
#include "victorious/kernels/shorten.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr int kIterations = 20;
constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kStep = 3;  // every third descriptor: neighbouring views repeat them

// One row of kernels::kShortBytes floats per descriptor.
Expected<cv::Mat> ReadDescriptors(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<fs::path> files, ListFolder(settings.scenes / ".." / "assets" / "models"));
  std::erase_if(files, [](const fs::path& file) { return file.extension() != ".glb"; });
  std::vector<float> values;
  for (const fs::path& file : files) {
    settings.progress(file.filename().string());
    VICTORIOUS_ASSIGN_OR_RETURN(const auto model, LoadOrBuildModel(settings, file, {}));
    const std::vector<std::int8_t> rows = kernels::ShortenToQueries(model->features.descriptors);
    for (std::size_t i = 0; i < rows.size() / kernels::kShortBytes; i += kStep) {
      const auto row = rows.begin() + static_cast<std::ptrdiff_t>(i * kernels::kShortBytes);
      std::copy_n(row, kernels::kShortBytes, std::back_inserter(values));
    }
  }
  if (values.empty()) return Fail(ErrorCode::kNotFound, "assets/models: no .glb files");
  return cv::Mat(values, true).reshape(1, static_cast<int>(values.size() / kernels::kShortBytes));
}

}  // namespace

Expected<Report> RunDescriptorCells(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat descriptors, ReadDescriptors(settings));
  settings.progress(fmt::format("{} cells of {} descriptors", kDescriptorCells, descriptors.rows));
  cv::setRNGSeed(kSeed);
  cv::Mat labels;
  cv::Mat centres;
  const double squared = cv::kmeans(descriptors, static_cast<int>(kDescriptorCells), labels,
                                    {cv::TermCriteria::MAX_ITER, kIterations, 0}, 1, cv::KMEANS_PP_CENTERS, centres);
  std::string text;
  for (int cell = 0; cell < centres.rows; ++cell) {
    text += "{";
    for (int k = 0; k < centres.cols; ++k) {
      text += fmt::format("{}{}", k == 0 ? "" : ",", std::lround(centres.at<float>(cell, k)));
    }
    text += "},\n";
  }
  VICTORIOUS_RETURN_IF_ERROR(WriteFileAtomically(settings.out / "descriptor_cells.inc", text));
  return Report{.title = "Cells of shortened descriptors: k-means of the project's own CAD models",
                .notes = {"Writes descriptor_cells.inc; src/victorious/search/match/ holds a copy."},
                .columns = {"cells", "descriptors", "root mean square distance from the centre, steps"},
                .rows = {{static_cast<double>(centres.rows), static_cast<double>(descriptors.rows),
                          std::sqrt(squared / descriptors.rows)}},
                .plot = {}};
}

}  // namespace victorious
