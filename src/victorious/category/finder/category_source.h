// What finds objects of categories in frames: a model that was trained here (category_finder.h), a detector by channels
// that was trained here (channel_source.h), a detection network that was imported (detector_source.h), or another
// program that has found them before (detection_list_source.h). All make sightings alike.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <opencv2/core/types.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/category/category_model.h"
#include "victorious/category/channels/channel_detector.h"
#include "victorious/category/finder/detection_list.h"
#include "victorious/category/network/network_detector.h"
#include "victorious/geometry/box.h"
#include "victorious/types/frame.h"

namespace victorious {

struct CategoryFindOptions {
  double min_probability = 0.5;
  std::string background = "background";

  void ListFields(FieldList& fields);

  /// True if the category is one of `background`.
  [[nodiscard]] bool IsBackground(std::string_view name) const;
};

/// The categories of a detector that are reported: all but those of the background.
class ReportedCategories {
 public:
  /// Takes the next category of the detector.
  void Add(const std::string& name, const CategoryFindOptions& options);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

  /// The index into names() of a category of the detector; std::nullopt: background.
  [[nodiscard]] std::optional<std::size_t> Of(std::size_t of_detector) const { return number_[of_detector]; }

 private:
  std::vector<std::string> names_;
  std::vector<std::optional<std::size_t>> number_;
};

struct FoundCategory {
  std::size_t category = 0;                ///< index into CategorySource::names()
  Box box;                                 ///< px, inside the frame
  double probability = 0;                  ///< calibrated; of a detector its own score
  bool is_tracked = false;                 ///< from an earlier frame to this one
  std::optional<std::int64_t> track = {};  ///< of a source that follows objects by itself: the same object
};

/// Thread-safe.
class CategorySource {
 public:
  CategorySource() = default;
  CategorySource(const CategorySource&) = default;
  CategorySource(CategorySource&&) = default;
  CategorySource& operator=(const CategorySource&) = default;
  CategorySource& operator=(CategorySource&&) = default;
  virtual ~CategorySource() = default;

  /// The categories that are reported.
  [[nodiscard]] virtual const std::vector<std::string>& names() const = 0;
  /// Identifies the results of the source.
  [[nodiscard]] virtual const std::string& content_id() const = 0;

  /// True for a detector: it needs Frame::bgr, searches some of the frames, and what it finds is tracked in between.
  [[nodiscard]] virtual bool IsDetector() const { return false; }
  /// True for what was found before, in one video: it is entered, nothing is searched for.
  [[nodiscard]] virtual bool IsListed() const { return false; }
  /// What a search of a frame of this size takes, for a person; empty: nothing to say.
  [[nodiscard]] virtual std::string DescribeSearch([[maybe_unused]] cv::Size frame) const { return {}; }

  [[nodiscard]] virtual Expected<std::vector<FoundCategory>> FindIn(const Frame& frame) const = 0;
};

/// The content of a file of categories, of any kind.
using CategorySourceModel = std::variant<CategoryModel, DetectorModel, ChannelModel>;

/// What a source is made of.
using CategorySourceInput = std::variant<CategorySourceModel, DetectionList>;

/// Reads a category model, a detector by channels or an imported detector. Errors: those of ReadCategoryModel,
/// ReadChannelModel and ReadDetector.
[[nodiscard]] Expected<CategorySourceModel> ReadCategorySource(const std::filesystem::path& path);

/// Errors: those of Create() of CategoryFinder, ChannelSource, DetectorSource and DetectionListSource.
[[nodiscard]] Expected<std::shared_ptr<const CategorySource>> MakeCategorySource(CategorySourceInput input,
                                                                                 const CategoryFindOptions& options,
                                                                                 const DetectorOptions& detector);

}  // namespace victorious
